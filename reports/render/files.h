#pragma once

#include <filesystem>
#include <string>

#include "files/output_file.h"

namespace moma::reports {

/// files::write_file() of a text, with its folder made. Throws ReportError.
void write_text(const std::filesystem::path& file, const files::Kind& kind, files::Replace replace,
                const std::string& text);

}  // namespace moma::reports
