#pragma once

#include <cstdio>
#include <string>

namespace moma {

/// As printf has it; up to 200 characters.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

}  // namespace moma
