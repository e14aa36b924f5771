#include "reports/render/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ostream>

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

void write_text(const std::filesystem::path& file, const files::Kind& kind, files::Replace replace,
                const std::string& text) {
  std::error_code error;  // writing says what is wrong with a folder that cannot be made
  std::filesystem::create_directories(files::behind_links(file).parent_path(), error);
  try {
    files::write_file(file, kind, replace,
                      [&](std::ostream& out) { out.write(text.data(), static_cast<std::streamsize>(text.size())); });
  } catch (const files::OutputError& failure) {
    throw ReportError(failure.what());
  }
}

}  // namespace moma::reports
