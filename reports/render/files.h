#pragma once

#include <filesystem>
#include <string>

namespace moma::reports {

/// Removes the file or folder at its end, unless it was renamed away.
struct Temporary {
  std::filesystem::path path;
  ~Temporary();
};

/// Writes the file whole or not at all: beside its place, then renamed. Makes its folder. Throws ReportError.
void write_atomically(const std::filesystem::path& file, const std::string& text);

}  // namespace moma::reports
