#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <stdexcept>
#include <string>

namespace moma::files {

/// A file that is not writable or may not be replaced; what() is complete, for a person.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Kind {
  std::string name;  ///< "report page of moma's"
  /// Text that occurs in the first or last 64 KiB of every file of this kind and hardly in any other, so that an
  /// earlier file is recognised and may be replaced. Empty: files of this kind are edited by hand, or look like those
  /// of others.
  std::string mark;
};

/// Files that an output may replace. An empty file may always be replaced, a store of moma's never.
enum class Replace {
  kOwn,  ///< files with the mark of the same kind
  kAny   ///< every file except a store: --force
};

/// Resolves the symbolic links of `file`, even if the last one leads to nothing yet. Follows at most forty links.
/// Throws std::filesystem::filesystem_error if a link cannot be read.
std::filesystem::path behind_links(const std::filesystem::path& file);

/// Throws OutputError if `file` is a folder, or exists and may not be replaced by a file of `kind`, with its name, its
/// kind and the remedy. For commands that compute before they write; write_file() checks as well.
void check_replace(const std::filesystem::path& file, const Kind& kind, Replace replace);

/// Writes a file whole or not at all: `write` fills a file beside it, which then replaces it with the former access
/// rights. A symbolic link stays, and its target is written. A file that is not regular (a FIFO, a device) is written
/// into, never replaced. Throws OutputError.
void write_file(const std::filesystem::path& file, const Kind& kind, Replace replace,
                const std::function<void(std::ostream&)>& write);

/// Makes `part`, closed and complete, durable against loss of power and renames it to `file`. Throws OutputError and
/// keeps `part` on failure.
void put_in_place(const std::filesystem::path& part, const std::filesystem::path& file);

}  // namespace moma::files
