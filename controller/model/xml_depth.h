#pragma once

#include <string>

namespace moma {

/// Elements that one XML element may lie in: parsers recurse, so more are refused before one sees the text.
inline constexpr int kMaxXmlDepth = 200;

/// Greatest depth of elements; of what is not well-formed, no less than a parser comes to before it notices.
int xml_depth(const std::string& text);

}  // namespace moma
