#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <stdexcept>
#include <string>

namespace moma::files {

/// A file that cannot be written or may not be replaced; what() is complete, for a person.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a command writes.
struct Kind {
  std::string name;  ///< "report page of moma's"
  /// Occurs in the first or last 64 KiB of every file of this kind and hardly in any other, so that an earlier one is
  /// known and may be replaced. Empty: files of this kind are edited by hand, or look like those of others.
  std::string mark;
};

/// Which files an output may take the place of. An empty file always gives way; a store of moma's never.
enum class Replace {
  kOwn,  ///< files that carry the mark of the same kind
  kAny   ///< every file but a store: --force
};

/// Where writing to `file` ends: behind its symbolic links, also where the last one leads to nothing yet. Not more than
/// forty links are followed. Throws std::filesystem::filesystem_error where one cannot be read.
std::filesystem::path behind_links(const std::filesystem::path& file);

/// True where the file begins like an SQLite database that says it is moma's.
bool is_store(const std::filesystem::path& file);

/// Throws OutputError where `file` is a folder, or is there and may not be replaced by a file of `kind`: naming it,
/// what it is and the way out. For commands that compute before they write; write_file() looks as well.
void check_replace(const std::filesystem::path& file, const Kind& kind, Replace replace);

/// Writes a file whole or not at all: `write` fills a file beside it, which then takes its place, with the access
/// rights of what was there. A symbolic link stays: what it points to is written. What is no regular file (a FIFO, a
/// device) is written into, never replaced. Throws OutputError.
void write_file(const std::filesystem::path& file, const Kind& kind, Replace replace,
                const std::function<void(std::ostream&)>& write);

/// Makes sure that `part`, closed and complete, and its new name survive a loss of power, and renames it to `file`.
/// Throws OutputError, and leaves `part` then.
void put_in_place(const std::filesystem::path& part, const std::filesystem::path& file);

}  // namespace moma::files
