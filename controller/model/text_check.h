#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace moma {

/// Number of bytes of the character at the beginning of `text`; 0 for an invalid one (RFC 3629).
inline std::size_t utf8_length(std::string_view text) noexcept {
  const auto byte = [text](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return text.empty() ? 0 : 1;
  const std::size_t length = lead >= 0xc2 && lead < 0xe0 ? 2 : lead >= 0xe0 && lead < 0xf0 ? 3 : lead < 0xf5 ? 4 : 0;
  if (lead < 0xc2 || length == 0) return 0;
  const unsigned low = lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : 0x80;   // only shortest forms,
  const unsigned high = lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : 0xbf;  // no surrogates, nothing beyond U+10FFFF
  if (byte(1) < low || byte(1) > high) return 0;
  for (std::size_t i = 2; i < length; ++i)
    if (byte(i) < 0x80 || byte(i) > 0xbf) return 0;
  return length;
}

/// The first byte that belongs to no character, or is NUL; npos if all of `text` is UTF-8. Names and whole files become
/// JSON in stores, which requires UTF-8; readers take NUL for the end, or for a sign of UTF-16 or UTF-32.
inline std::size_t not_text(std::string_view text) noexcept {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text.substr(at));
    if (length == 0 || text[at] == '\0') return at;
    at += length;
  }
  return std::string_view::npos;
}

/// Message about the byte at `at`, found by not_text().
inline std::string not_text_message(std::string_view text, std::size_t at) {
  constexpr const char* kDigits = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(text[at]);
  if (byte == 0) return "the byte 0x00 is no part of a text";
  return std::string("the byte 0x") + kDigits[byte >> 4U] + kDigits[byte & 0xfU] +
         " is not UTF-8, which text has to be";
}

/// Line of a byte, from 1.
inline std::size_t line_of(std::string_view text, std::size_t at) noexcept {
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace moma
