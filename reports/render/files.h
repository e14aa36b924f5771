#pragma once

#include <filesystem>
#include <string>

namespace moma::reports {

/// Removes the file or folder at its end, unless it was renamed away.
struct Temporary {
  std::filesystem::path path;
  ~Temporary();
};

/// Makes an empty folder of its own among the system's temporary ones, moma-PURPOSE-.... Throws ReportError.
std::filesystem::path temporary_folder(const std::string& purpose);

/// Writes the file whole or not at all: beside its place, then renamed. A symbolic link stays, and what it points to is
/// written; a FIFO or a device is written into, never replaced. Makes its folder. Throws ReportError.
void write_atomically(const std::filesystem::path& file, const std::string& text);

}  // namespace moma::reports
