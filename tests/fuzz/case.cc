// Case files: read, and solved as `moma solve` does. Paths in them start at the working folder, the source's.
#include "controller/case/case_file.h"
#include "controller/case/solve.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  try {
    const ControlCase control_case = read_case(config::parse_yaml(fuzz::text_of(data, size), "fuzz.json"));
    (void)layout(solve(control_case));
  } catch (const config::ConfigError&) {
  }
  return 0;
}
