#include "eval/cli/whole_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "eval/cli/command.h"

namespace moma::cli {

namespace fs = std::filesystem;

void write_whole(const fs::path& file, const std::function<void(std::ostream&)>& write) {
  const fs::path part = file.string() + ".part";
  std::ofstream out(part, std::ios::binary);
  write(out);
  out.close();
  std::error_code error;
  if (out) fs::rename(part, file, error);
  if (!out || error) {
    const std::string why = error ? error.message() : std::strerror(errno);
    fs::remove(part, error);
    throw UsageError(fmt::format("{}: cannot be written: {}", file.string(), why));
  }
}

}  // namespace moma::cli
