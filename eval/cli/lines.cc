#include "eval/cli/lines.h"

#include <algorithm>

#include "eval/cli/table.h"

namespace moma::cli {

std::string terminal_safe_lines(std::string_view text) {
  std::string safe;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    safe += (begin > 0 ? "\n" : "") + terminal_safe(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return safe;
}

}  // namespace moma::cli
