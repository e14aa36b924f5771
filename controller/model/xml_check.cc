#include "controller/model/xml_check.h"

#include <algorithm>

namespace moma {
namespace {

// Position after `end`, or the text's end without one.
std::size_t after(const std::string& text, std::size_t from, const char* end) {
  const std::size_t at = text.find(end, from);
  return at == std::string::npos ? text.size() : at + std::char_traits<char>::length(end);
}

// Position after the '>' of a tag, ignoring quoted text.
std::size_t after_tag(const std::string& text, std::size_t at) {
  char quote = '\0';
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at + 1;
    }
  }
  return at;
}

}  // namespace

int xml_depth(const std::string& text) {
  int depth = 0;
  int deepest = 0;
  for (std::size_t i = text.find('<'); i < text.size(); i = text.find('<', i)) {
    if (text.compare(i, 4, "<!--") == 0) {
      i = after(text, i, "-->");
    } else if (text.compare(i, 9, "<![CDATA[") == 0) {
      i = after(text, i, "]]>");
    } else if (text.compare(i, 2, "<!") == 0 || text.compare(i, 2, "<?") == 0) {
      i = after(text, i, ">");
    } else if (text.compare(i, 2, "</") == 0) {
      depth = std::max(0, depth - 1);
      i = after(text, i, ">");
    } else {
      deepest = std::max(deepest, ++depth);
      i = after_tag(text, i + 1);
      if (i >= 2 && text[i - 1] == '>' && text[i - 2] == '/') --depth;
    }
  }
  return deepest;
}

std::string_view next_word(std::string_view& text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace moma
