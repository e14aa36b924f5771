#pragma once

#include <string>

namespace moma {

/// Largest nesting depth of XML elements: parsers recurse, so deeper files are refused before parsing.
inline constexpr int kMaxXmlDepth = 200;

/// Greatest depth of elements; for malformed text at least the depth that a parser reaches before its error.
int xml_depth(const std::string& text);

}  // namespace moma
