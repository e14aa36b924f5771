#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <stdexcept>

namespace moma::store {

/// A file that cannot be written; what() is complete, for a person.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where writing to `file` ends: behind its symbolic links, also where the last one leads to nothing yet. Not more than
/// forty links are followed. Throws std::filesystem::filesystem_error where one cannot be read.
std::filesystem::path behind_links(const std::filesystem::path& file);

/// Writes a file whole or not at all: `write` fills a file beside it, which then takes its place, with the access
/// rights of what was there. A symbolic link stays: what it points to is written. What is no regular file (a FIFO, a
/// device) is written into, never replaced. Throws OutputError.
void write_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

/// Makes sure that `part`, closed and complete, and its new name survive a loss of power, and renames it to `file`.
/// Throws OutputError, and leaves `part` then.
void put_in_place(const std::filesystem::path& part, const std::filesystem::path& file);

}  // namespace moma::store
