#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace moma {

/// The main() of a program that is called with a suite and, 20 unless told otherwise, how many of its first worlds:
/// PROGRAM SUITE [COUNT], where `count` is that second word in the usage line. The exit code; errors go to stderr.
int suite_program(int argc, char** argv, const char* count,
                  const std::function<void(const std::string& suite, std::uint64_t worlds)>& run);

}  // namespace moma
