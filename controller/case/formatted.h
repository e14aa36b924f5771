#pragma once

#include <concepts>
#include <cstdio>
#include <string>

namespace moma {

/// Formats as printf does, without "-0"; at most 300 characters.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  const auto plain = [](auto value) {
    if constexpr (std::floating_point<decltype(value)>)
      return value + 0.0;
    else
      return value;
  };
  char buffer[300];
  std::snprintf(buffer, sizeof buffer, format, plain(values)...);
  return buffer;
}

}  // namespace moma
