#include "reports/render/files.h"

#include <ostream>

#include "reports/render/report.h"

namespace moma::reports {

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
