#include "reports/render/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

#include "reports/render/html.h"
#include "reports/render/page_data.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

/// Removes the file unless it was renamed away.
struct Temporary {
  std::filesystem::path path;
  ~Temporary() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

void write_atomically(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(file, error)) {
    throw ReportError(fmt::format("{}: this is a folder; wanted: the name of the page's file", file.string()));
  }
  const Temporary temporary{folder / fmt::format(".{}.{}.part", file.filename().string(), getpid())};
  std::ofstream out(temporary.path, std::ios::binary | std::ios::trunc);
  if (!out) {
    throw ReportError(
        fmt::format("{}: cannot be written; wanted: a folder that exists and may be written to", file.string()));
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw ReportError(fmt::format("{}: cannot be written: the disk may be full", file.string()));
  std::filesystem::rename(temporary.path, file, error);
  if (error) throw ReportError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

}  // namespace

void write_report(const std::filesystem::path& db, const std::filesystem::path& html_file,
                  const ReportOptions& options) {
  if (options.replays < 0) throw ReportError("replays: wanted: 0 or more");
  if (!(options.replay_hz > 0.0)) throw ReportError("replay_hz: wanted: more than 0");
  std::string text;
  try {
    SQLite::Database store = open_store(db);
    text = html(page_data(store, options));
  } catch (const SQLite::Exception& error) {
    throw ReportError(fmt::format("{}: cannot be read: {}", db.string(), error.what()));
  } catch (const nlohmann::json::exception& error) {
    throw ReportError(fmt::format("{}: holds JSON that cannot be read: {}", db.string(), error.what()));
  }
  write_atomically(html_file, text);
}

}  // namespace moma::reports
