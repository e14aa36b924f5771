#include "eval/store/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace moma::store {
namespace {

namespace fs = std::filesystem;

OutputError cannot(const fs::path& file, const std::string& why) {
  return OutputError(fmt::format("{}: cannot be written: {}", file.string(), why));
}

std::string reason() { return errno != 0 ? std::strerror(errno) : "the disk may be full"; }

/// False, with errno, where it cannot be done; file systems that know no such thing count as done.
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

}  // namespace

fs::path behind_links(const fs::path& file) {
  fs::path place = file;
  std::error_code error;
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(place, error)); ++links) {
    const fs::path target = fs::read_symlink(place);  // throws: what it leads to is not to be guessed
    place = target.is_absolute() ? target : place.parent_path() / target;
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

void write_file(const fs::path& file, const std::function<void(std::ostream&)>& write) {
  const fs::path place = behind_links(file);
  std::error_code error;
  const fs::file_status status = fs::status(place, error);
  if (fs::is_directory(status)) throw OutputError(fmt::format("{}: is a folder", file.string()));
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

}  // namespace moma::store
