#include "eval/cli/option_parts.h"

namespace moma::cli {

std::vector<std::string> words_accepted_by(const CLI::Option& option) {
  const std::string& text = option.get_option_text();
  if (text.find('|') != std::string::npos) return CLI::detail::split(text, '|');
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}');
  if (open == std::string::npos || close == std::string::npos || close < open) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

}  // namespace moma::cli
