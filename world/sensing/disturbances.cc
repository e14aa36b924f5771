#include "world/sensing/disturbances.h"

#include <algorithm>
#include <cmath>

#include "controller/config/read_described.h"
#include "controller/config/text_file.h"
#include "controller/config/write_described.h"
#include "controller/describe/complete.h"
#include "world/sensing/disturbances_file.h"

namespace moma {

bool senses_with_errors(const Disturbances& disturbances) {
  Disturbances reduced = disturbances;
  const Disturbances off;
  reduced.seed = off.seed;
  for (PoseSensing* poses : {&reduced.objects, &reduced.goal}) {
    poses->frame = SensingFrame::kWorld;
    poses->resting_is_known = false;
  }
  reduced.detection.sensor = off.detection.sensor;
  reduced.detection.known_at_start = off.detection.known_at_start;
  reduced.detection.mount = off.detection.mount;
  reduced.detection.axis = off.detection.axis;
  reduced.detection.lost = off.detection.lost;
  if (reduced.detection.missed.probability == 0.0) reduced.detection.missed = {};
  if (reduced.detection.phantoms.count == 0) reduced.detection.phantoms = {};
  if (reduced.base.odometry.slip.rate == 0.0) reduced.base.odometry.slip = {};
  reduced.actuators = off.actuators;
  reduced.payload = off.payload;
  reduced.floor = off.floor;
  reduced.control = off.control;
  return !is_off(reduced);
}

bool acts_with_errors(const Disturbances& disturbances) {
  Actuators reduced = disturbances.actuators;
  reduced.joints.friction = {};
  return !is_off(reduced);
}

bool moves_with_errors(const Disturbances& disturbances) {
  UnknownPayload payload = disturbances.payload;
  payload.position = {};
  return !is_off(disturbances.actuators.joints.friction) || !is_off(payload) || !is_off(disturbances.floor);
}

long delay_steps(double delay, double control_period) {
  const double periods = std::ceil(delay / control_period * (1.0 - 1e-12) - 1e-9);
  return static_cast<long>(std::max(0.0, periods));
}

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
    if (!fs::is_regular_file(file, error)) config::fail(node.mark, key, "no such file: " + file.string());
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

Json to_json(const Disturbances& disturbances) {
  if (!any(disturbances)) return Json::object();
  Disturbances said = disturbances;
  // Without a payload its position is not written, and does not enter a trial's key.
  if (said.payload.mass == 0.0 && said.payload.spread == 0.0) said.payload = {};
  return config::write_described(said);
}

}  // namespace moma
