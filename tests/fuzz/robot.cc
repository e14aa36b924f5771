// Robot files; paths in them start at the working folder, the source's.
#include "controller/config/robot_file.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  try {
    const auto robot = config::read_robot(config::parse_yaml(fuzz::text_of(data, size), "fuzz.yaml"), "");
    (void)robot.resolved.dump();  // what is accepted can be stored and built again
    (void)config::robot_from_resolved(robot.resolved);
  } catch (const config::ConfigError&) {
  }
  return 0;
}
