#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace moma::cli {

/// A word that can stand where the cursor is; it begins with what is typed already.
struct Candidate {
  std::string text;
  std::string description;  ///< one line, or ""
};

struct Completion {
  std::vector<Candidate> candidates;
  bool files = false;                ///< names of files can stand there as well
  std::vector<std::string> endings;  ///< of such files, without the dot; empty: any
};

/// What can follow on a command line: `words` are those behind the program's name, the last one as far as it is typed,
/// "" where it is not begun. Options and their values come from the descriptions of the commands, keys from those of
/// the files, names of trials and controllers from the store that the line names. Throws nothing for a line that makes
/// no sense or names what is not there: there are no candidates then.
Completion complete(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace moma::cli
