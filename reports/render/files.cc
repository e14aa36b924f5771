#include "reports/render/files.h"

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

void write_atomically(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(file, error)) {
    throw ReportError(fmt::format("{}: this is a folder; wanted: the name of a file", file.string()));
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

}  // namespace moma::reports
