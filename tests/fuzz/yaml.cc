// YAML as robots, suites, controllers and cases are written in.
#include <cstdlib>

#include "controller/config/json_node.h"
#include "controller/config/node.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  try {
    const config::Node node = config::parse_yaml(fuzz::text_of(data, size), "fuzz.yaml");
    const auto json = config::node_to_json(node);
    if (config::node_to_json(config::node_from_json(json, "again")) != json) std::abort();
    (void)json.dump();  // as stores keep it
  } catch (const config::ConfigError&) {
  }
  return 0;
}
