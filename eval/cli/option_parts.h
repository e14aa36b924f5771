#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace moma::cli {

/// What the completion of lines and the manual ask of an option.
inline bool is_positional(const CLI::Option& option) { return !option.nonpositional(); }
inline bool wants_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// The only words that it takes: those between bars in its text, or between braces in the name of its type; none where
/// others are taken, too.
std::vector<std::string> words_accepted_by(const CLI::Option& option);

}  // namespace moma::cli
