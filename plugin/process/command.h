#pragma once

#include <compare>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "controller/describe/describe.h"

namespace moma {

/// Guards around a controller in a process of its own: what exceeds them ends the trial as an error.
struct ProcessLimits {
  double deadline = 500.0;  ///< of a step's answer [control periods]
  double start = 60.0;      ///< of starting, of its setup and of each reset [s]
  double memory = 4.0;      ///< of its data [GB]

  auto operator<=>(const ProcessLimits&) const = default;
};

constexpr void describe(auto& v, Of<ProcessLimits>) {
  using T = ProcessLimits;
  v.member(
      "deadline", &T::deadline,
      in_range({1.0, 1e9}, "control periods", "real time in which a step has to be answered; a guard against hanging"));
  v.member("start", &T::start, in_range({0.1, 1e6}, "s", "the same for starting and for each reset"));
  v.member("memory", &T::memory, in_range(Range::positive_or_inf(), "GB", "data that the process may have"));
}

/// Command of a controller's processes, and their files.
struct ProcessCommand {
  /// The first is the program: where it has no '/' PATH is searched, else it is relative to `directory`.
  std::vector<std::string> arguments;
  fs::path directory;                    ///< absolute; where it works
  std::vector<std::string> environment;  ///< NAME=VALUE, beside and instead of this process's own
  std::vector<fs::path> files;           ///< absolute; the process may name more when it is ready
  ProcessLimits limits;

  auto operator<=>(const ProcessCommand&) const = default;
};

/// Returns the command that runs a class of a Python file (docs/how-to/python-controller.md) with moma's runner. Its
/// environment fixes the order of sets and the threads of linear algebra. The caller sets `limits` and further files.
ProcessCommand python_command(const std::string& interpreter, const fs::path& file, const std::string& class_name);

}  // namespace moma
