#include "reports/render/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "reports/render/report.h"

namespace moma::reports {

Temporary::~Temporary() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

std::filesystem::path temporary_folder(const std::string& purpose) {
  std::string name = (std::filesystem::temp_directory_path() / ("moma-" + purpose + "-XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) {
    throw ReportError(fmt::format("{}: no temporary folder can be made: {}", name, std::strerror(errno)));
  }
  return name;
}

namespace {

namespace fs = std::filesystem;

/// Where writing ends behind symbolic links, also where the last one leads to nothing yet. eval/store/output_file.cc
/// has the like: the reports see no source but their own, and link neither the evaluation nor the controller.
fs::path behind_links(fs::path place) {
  std::error_code error;
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(place, error)); ++links) {
    const fs::path target = fs::read_symlink(place);  // throws: what it leads to is not to be guessed
    place = target.is_absolute() ? target : place.parent_path() / target;
  }
  return place;
}

void fill(const fs::path& named, const fs::path& file, std::ios::openmode mode, const std::string& text) {
  std::ofstream out(file, std::ios::binary | mode);
  if (!out) {
    throw ReportError(
        fmt::format("{}: cannot be written; wanted: a folder that exists and may be written to", named.string()));
  }
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw ReportError(fmt::format("{}: cannot be written: the disk may be full", named.string()));
}

/// What is renamed before it has reached the disk is an empty file after a loss of power.
bool reached_disk(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool done = fsync(descriptor) == 0 || errno == EINVAL;
  close(descriptor);
  return done;
}

}  // namespace

void write_atomically(const std::filesystem::path& file, const std::string& text) {
  const fs::path place = behind_links(file);
  const fs::path folder = place.has_parent_path() ? place.parent_path() : ".";
  std::error_code error;
  fs::create_directories(folder, error);
  const fs::file_status status = fs::status(place, error);
  if (fs::is_directory(status)) {
    throw ReportError(fmt::format("{}: this is a folder; wanted: the name of a file", file.string()));
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) return fill(file, place, std::ios::out, text);
  const Temporary temporary{folder / fmt::format(".{}.{}.part", place.filename().string(), getpid())};
  fill(file, temporary.path, std::ios::trunc, text);
  if (!reached_disk(temporary.path))
    throw ReportError(fmt::format("{}: cannot be written: the disk may be full", file.string()));
  if (fs::exists(status)) fs::permissions(temporary.path, status.permissions(), error);
  fs::rename(temporary.path, place, error);
  if (error) throw ReportError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

}  // namespace moma::reports
