#pragma once

#include <cstdint>
#include <string>

namespace moma::fuzz {

/// A text of YAML or JSON with some values changed for others, taken out, doubled, exchanged, put under another key:
/// bytes alone seldom leave a file that is one. Returns JSON, "" where the text cannot be read or nothing is left. The
/// same seed gives the same change.
std::string changed_structure(const std::string& text, std::uint64_t seed);

}  // namespace moma::fuzz
