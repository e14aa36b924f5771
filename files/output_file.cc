#include "files/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

namespace moma::files {
namespace {

namespace fs = std::filesystem;

OutputError cannot(const fs::path& file, const std::string& why) {
  return OutputError(fmt::format("{}: cannot be written: {}", file.string(), why));
}

std::string reason() { return errno != 0 ? std::strerror(errno) : "the disk may be full"; }

/// False, with errno, on failure; file systems without synchronisation count as done.
bool synchronise(const fs::path& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool done = fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int error = errno;
  close(descriptor);
  errno = error;
  return done;
}

void fill(const fs::path& named, const fs::path& file, std::ios::openmode mode,
          const std::function<void(std::ostream&)>& write) {
  errno = 0;
  std::ofstream out(file, std::ios::binary | mode);
  if (!out) throw cannot(named, reason());
  write(out);
  errno = 0;
  out.close();
  if (!out) throw cannot(named, reason());
}

constexpr std::streamsize kEnd = 64 * 1024;  // [byte] of either end of a file that are searched for its mark

/// The first and the last kEnd bytes of a file, or all of a shorter one.
std::string ends_of(const fs::path& named, const fs::path& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string text(2 * kEnd, '\0');
  in.read(text.data(), 2 * kEnd);
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (in) {  // there is more
    in.seekg(-kEnd, std::ios::end);
    in.read(text.data() + kEnd, kEnd);
  }
  if (!in.is_open() || in.bad())
    throw OutputError(
        fmt::format("{}: exists but cannot be read, so that its kind is unknown: {}; remove it, or name another file",
                    named.string(), reason()));
  return text;
}

// SQLite's file format: magic, and PRAGMA application_id at byte 68, which for a store of moma's is "moma".
bool begins_like_database(std::string_view text) { return text.starts_with(std::string_view("SQLite format 3\0", 16)); }
bool begins_like_store(std::string_view text) {
  return begins_like_database(text) && text.size() >= 72 && text.substr(68, 4) == "moma";
}

/// Description for messages: "an empty file".
std::string_view what_it_is(std::string_view text) {
  if (begins_like_database(text)) return "a database of another program";
  const auto printable = [](unsigned char c) { return c >= ' ' || c == '\n' || c == '\t' || c == '\r'; };
  return std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(text.size(), 512)),
                     printable)
             ? "another text file"
             : "another file";
}

}  // namespace

void check_replace(const fs::path& file, const Kind& kind, Replace replace) {
  const fs::path place = behind_links(file);
  std::error_code error;
  const fs::file_status status = fs::status(place, error);
  if (fs::is_directory(status))
    throw OutputError(fmt::format("{}: is a folder; expected the name of a file", file.string()));
  if (!fs::is_regular_file(status)) return;
  const std::string text = ends_of(file, place);
  if (text.empty()) return;
  // While a store is written, the log beside it may contain everything except the magic.
  if (begins_like_store(text) || (begins_like_database(text) && fs::exists(place.string() + "-wal", error)))
    throw OutputError(
        fmt::format("{}: is a store of moma's, which nothing else replaces; name another file", file.string()));
  if (replace == Replace::kAny) return;
  if (kind.mark.empty())
    throw OutputError(
        fmt::format("{}: is there already; name another file, or replace it with --force", file.string()));
  if (text.find(kind.mark) == std::string::npos)
    throw OutputError(fmt::format("{}: is {}, no {}; name another file, or replace it with --force", file.string(),
                                  what_it_is(text), kind.name));
}

fs::path behind_links(const fs::path& file) {
  fs::path place = file;
  std::error_code error;
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(place, error)); ++links) {
    const fs::path target = fs::read_symlink(place);  // throws for an unreadable link
    const fs::path next = target.is_absolute() ? target : place.parent_path() / target;
    // The target of /dev/stdout, a pipe, has no path: the link itself opens it.
    if (!fs::exists(fs::symlink_status(next, error)) && fs::exists(place, error)) return place;
    place = next;
  }
  return place;
}

void put_in_place(const fs::path& part, const fs::path& file) {
  if (!synchronise(part, O_RDONLY)) throw cannot(file, reason());
  std::error_code error;
  fs::rename(part, file, error);
  if (error) throw cannot(file, error.message());
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!synchronise(folder, O_RDONLY | O_DIRECTORY)) throw cannot(file, reason());
}

void write_file(const fs::path& file, const Kind& kind, Replace replace,
                const std::function<void(std::ostream&)>& write) {
  check_replace(file, kind, replace);
  const fs::path place = behind_links(file);
  std::error_code error;
  const fs::file_status status = fs::status(place, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return fill(file, place, std::ios::out, write);
  const fs::path part = place.string() + fmt::format(".{}.part", getpid());
  try {
    fill(file, part, std::ios::trunc, write);
    if (fs::exists(status)) fs::permissions(part, status.permissions(), error);
    put_in_place(part, place);
  } catch (...) {
    fs::remove(part, error);
    throw;
  }
}

}  // namespace moma::files
