#include "controller/config/text_file.h"

#include <fstream>
#include <stdexcept>
#include <vector>

namespace moma::config {

std::string read_text_file(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw std::runtime_error("no such file");
  if (!fs::is_regular_file(status)) throw std::runtime_error("not a file");
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (!error && bytes > kMaxTextBytes)
    throw std::runtime_error("more than " + std::to_string(kMaxTextBytes >> 20U) + " MiB of text");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot be read (permissions?)");
  // Uses read(): functions that copy whole streams mistake an error of reading, or memory that runs out, for the end of
  // the file.
  std::string text;
  std::vector<char> part(1U << 16U);
  do {
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part.data(), static_cast<std::size_t>(in.gcount()));
  } while (in);
  if (in.bad()) throw std::runtime_error("cannot be read to its end");
  return text;
}

std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 200;
  return text.size() <= kMost ? text : text.substr(0, kMost) + "... (" + std::to_string(text.size()) + " bytes)";
}

}  // namespace moma::config
