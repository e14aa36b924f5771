#pragma once

#include <string>
#include <string_view>

namespace moma::cli {

/// terminal_safe() of a text of several lines, whose ends stay.
std::string terminal_safe_lines(std::string_view text);

}  // namespace moma::cli
