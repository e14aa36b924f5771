#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace moma::config {

/// " (did you mean WORD?)", or "" where none of `known` is near to `word`.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace moma::config
