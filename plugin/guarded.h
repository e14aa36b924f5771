#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>

namespace moma::plugin {

/// Runs `body`; what it throws becomes `failed` and a text, as the functions of a plugin hand it over: no exception
/// crosses the border of C.
template <typename Result, typename Body>
Result guarded(Result failed, char* error, std::size_t error_size, Body body) noexcept {
  const auto say = [&](const char* text) {
    if (error == nullptr || error_size == 0) return;
    const std::size_t length = std::min(std::strlen(text), error_size - 1);
    std::memcpy(error, text, length);
    error[length] = '\0';
  };
  try {
    return body();
  } catch (const std::exception& e) {
    say(e.what());
  } catch (...) {
    say("an exception of unknown type");
  }
  return failed;
}

}  // namespace moma::plugin
