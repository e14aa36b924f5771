#pragma once

#include <filesystem>
#include <string>

#include "files/output_file.h"

namespace moma::reports {

/// Removes the file or folder at its end, unless it was renamed away.
struct Temporary {
  std::filesystem::path path;
  ~Temporary();
};

/// Makes an empty folder of its own among the system's temporary ones, moma-PURPOSE-.... Throws ReportError.
std::filesystem::path temporary_folder(const std::string& purpose);

/// files::write_file() of a text, with its folder made. Throws ReportError.
void write_text(const std::filesystem::path& file, const files::Kind& kind, files::Replace replace,
                const std::string& text);

}  // namespace moma::reports
