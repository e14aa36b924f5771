// Worlds, as frozen sets and stores have them: what is read is written to what is read again.
#include <cstdlib>

#include "controller/config/json_node.h"
#include "tests/fuzz/target.h"
#include "world/world_json.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  try {
    const World world = world_from_json(config::parse_json(fuzz::text_of(data, size), "fuzz"), "fuzz");
    // As text, in which a value that is not known is null: NaN equals nothing.
    const auto json = to_json(world);
    if (to_json(world_from_json(json, "again")).dump() != json.dump()) std::abort();
  } catch (const config::ConfigError&) {
  }
  return 0;
}
