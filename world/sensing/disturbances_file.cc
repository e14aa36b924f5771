#include "world/sensing/disturbances_file.h"

#include <filesystem>

#include "controller/config/read_described.h"
#include "controller/config/text_file.h"
#include "controller/config/write_described.h"
#include "controller/describe/complete.h"

namespace moma {

static_assert(is_complete<Disturbances>());

Disturbances read_disturbances(const config::Node& node, const std::string& key) {
  if (node.kind == config::Node::Kind::kScalar) {
    if (node.scalar == "none") return {};
    if (!node.scalar.ends_with(".yaml") && !node.scalar.ends_with(".yml")) {
      config::fail(
          node.mark, key,
          "found '" + node.scalar + "', expected none, a file.yaml, or a map such as {joints: {noise: 0.001}}");
    }
    const auto file = config::directory_of(node.mark) / node.scalar;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) config::fail(node.mark, key, "no such file: " + file.string());
    const config::Node inside = config::load_yaml(file);
    if (inside.kind == config::Node::Kind::kScalar) {
      config::fail(inside.mark, "", "found '" + config::shortened(inside.scalar) + "', expected a map of disturbances");
    }
    return read_disturbances(inside, key);
  }
  Disturbances out;
  config::read_described(node, key, out);
  return out;
}

nlohmann::ordered_json to_json(const Disturbances& disturbances) {
  if (!any(disturbances)) return nlohmann::ordered_json::object();
  Disturbances said = disturbances;
  // Without a payload its position is not written, and does not enter a trial's key.
  if (said.payload.mass == 0.0 && said.payload.spread == 0.0) said.payload = {};
  return config::write_described(said);
}

}  // namespace moma
