// Controller files, for one robot.
#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/config/robot_file.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  static const auto kModel = config::load_robot("configs/robots/frankie.yaml").model;
  try {
    std::vector<std::string> warnings;
    const auto params = config::read_controller(
        config::parse_yaml(fuzz::text_of(data, size), "configs/controllers/fuzz.yaml"), "", *kModel, 0.02, warnings);
    (void)config::read_controller(config::node_from_json(config::to_json(params), "again"), "", *kModel, 0.02,
                                  warnings);
  } catch (const config::ConfigError&) {
  }
  return 0;
}
