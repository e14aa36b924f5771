#include "bench/suite_program.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

namespace moma {

int suite_program(int argc, char** argv, const char* count,
                  const std::function<void(const std::string& suite, std::uint64_t worlds)>& run) {
  if (argc < 2 || argc > 3) {
    fmt::print(stderr, "usage: {} SUITE [{}]\n", argv[0], count);
    return 2;
  }
  try {
    run(argv[1], argc == 3 ? std::strtoull(argv[2], nullptr, 10) : 20);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}

}  // namespace moma
