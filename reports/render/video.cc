#include "reports/render/video.h"

#include <fmt/format.h>

#include <cmath>

#include "reports/render/browser.h"
#include "reports/render/files.h"
#include "reports/render/html.h"
#include "reports/render/page_data.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

namespace fs = std::filesystem;

/// More than this between two frames would show as steps.
constexpr double kSamplesHz = 100.0;

void check(const VideoOptions& options) {
  for (const int side : {options.width, options.height})
    if (side < 64 || side > 4096 || side % 2 != 0)
      throw ReportError(fmt::format("a video of {} x {} pixels; wanted: even numbers from 64 to 4096", options.width,
                                    options.height));
  if (!(options.fps >= 1.0 && options.fps <= 120.0))
    throw ReportError(fmt::format("{} frames a second; wanted: 1 to 120", options.fps));
  if (!(options.speed > 0.0 && options.speed <= 1000.0))
    throw ReportError(fmt::format("a speed of {}; wanted: more than 0, at most 1000", options.speed));
}

int value_of(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

std::string from_base64(const std::string& text) {
  std::string bytes;
  unsigned word = 0;
  int bits = 0;
  for (const char c : text) {
    if (value_of(c) < 0) break;  // what fills up
    word = (word << 6) | static_cast<unsigned>(value_of(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>((word >> bits) & 0xff);
  }
  return bytes;
}

}  // namespace

int frames_of(double duration, const VideoOptions& options) {
  // A motion's end is a sum of control periods: half a thousandth of a frame of slack.
  return static_cast<int>(std::ceil(duration * options.fps / options.speed - 5e-4)) + 1;
}

int write_video(const fs::path& db, const std::string& trial, const fs::path& file, const VideoOptions& options) {
  check(options);
  ReportOptions parts;
  parts.look = options.look;
  parts.simulate = options.simulate;
  SQLite::Database store = open_store(db);
  std::optional<nlohmann::ordered_json> page = film_data(store, trial, kSamplesHz, parts);
  if (!page) throw ReportError(fmt::format("{}: has no trial {}", db.string(), trial));
  if (page->at("replays")[0].at("n") == 0)
    throw ReportError(fmt::format("{}: trial {} has no motion to show", db.string(), trial));
  (*page)["film"] = {
      {"width", options.width}, {"height", options.height}, {"fps", options.fps}, {"speed", options.speed}};
  const Temporary folder{temporary_folder("film")};
  const fs::path page_file = folder.path / "film.html";
  write_text(page_file, page_kind(), files::Replace::kOwn, html(*page));

  Browser browser(options.width, options.height);
  browser.open(page_file);
  const int frames = frames_of(browser.evaluate("momaFilm.begin()").get<double>(), options);
  for (int k = 0; k < frames; ++k) browser.evaluate(fmt::format("momaFilm.add({})", k));
  write_text(file, {"video", ""}, options.replace, from_base64(browser.evaluate("momaFilm.end()").get<std::string>()));
  return frames;
}

}  // namespace moma::reports
