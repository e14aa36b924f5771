#include "world/sensing/disturbances_file.h"

#include <filesystem>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;
using config::Range;
using Json = nlohmann::ordered_json;

// Two seconds are longer than any loop closed over them would bear, and bound the memory of what waits.
constexpr Range kDelay{0.0, 2.0};
constexpr Range kSpread{0.0, 10.0};
constexpr Range kGain{0.0, 1.0};
constexpr Range kFriction{0.0, 0.9};
constexpr Range kMass{0.0, 1000.0};

const Node kNothing;

const Node& child(MapReader& in, const char* name) {
  const Node* node = in.get(name);
  return node != nullptr ? *node : kNothing;
}

void read_pair(MapReader& in, const char* name, const char* first_name, double& first, const char* second_name,
               double& second, const Range& range = kSpread) {
  MapReader pair(child(in, name), in.key_of(name));
  pair.read(first_name, first, range);
  pair.read(second_name, second, range);
  pair.finish();
}

void read_spread(MapReader& in, const char* name, PoseSpread& spread) {
  read_pair(in, name, "position", spread.position, "rotation", spread.rotation);
}

void read_spread(MapReader& in, const char* name, TwistSpread& spread, const Range& range = kSpread) {
  read_pair(in, name, "linear", spread.linear, "angular", spread.angular, range);
}

void read_joints(MapReader& in, JointSensing& joints) {
  MapReader map(child(in, "joints"), in.key_of("joints"));
  map.read("noise", joints.noise, kSpread);
  map.read("velocity_noise", joints.velocity_noise, kSpread);
  map.read("bias", joints.bias, kSpread);
  map.read("delay", joints.delay, kDelay);
  map.finish();
}

void read_base(MapReader& in, BaseSensing& base) {
  MapReader map(child(in, "base"), in.key_of("base"));
  read_spread(map, "noise", base.noise);
  read_spread(map, "velocity_noise", base.velocity_noise);
  read_spread(map, "bias", base.bias);
  map.read("delay", base.delay, kDelay);
  MapReader odometry(child(map, "odometry"), map.key_of("odometry"));
  odometry.read("distance", base.odometry.distance, kGain);
  odometry.read("turn", base.odometry.turn, kGain);
  odometry.read("heading", base.odometry.heading, kSpread);
  read_spread(odometry, "walk", base.odometry.walk);
  odometry.finish();
  map.finish();
}

void read_poses(MapReader& map, PoseSensing& poses) {
  map.read_enum("frame", poses.frame, {{"world", SensingFrame::kWorld}, {"base", SensingFrame::kBase}});
  read_spread(map, "noise", poses.noise);
  read_spread(map, "velocity_noise", poses.velocity_noise);
  map.read("resting_is_known", poses.resting_is_known);
  read_spread(map, "bias", poses.bias);
  map.read("delay", poses.delay, kDelay);
}

void read_objects(MapReader& in, PoseSensing& objects, DetectionRule& detection) {
  MapReader map(child(in, "objects"), in.key_of("objects"));
  read_poses(map, objects);
  map.read("range", detection.range, Range::non_negative_or_inf());
  map.read("detection", detection.detection, {0.0, 3600.0});
  map.read("known_at_start", detection.known_at_start);
  if (const Node* sensor = map.get("sensor")) {
    const std::vector<double> place = config::read_numbers(*sensor, map.key_of("sensor"), 3, {-100.0, 100.0});
    std::copy(place.begin(), place.end(), detection.sensor.begin());
  }
  map.finish();
}

void read_spread(MapReader& in, const char* name, const char* mean, Spread& spread, const Range& range) {
  read_pair(in, name, mean, spread.mean, "spread", spread.spread, range);
}

void read_payload(MapReader& in, PhysicsErrors& physics) {
  MapReader map(child(in, "payload"), in.key_of("payload"));
  map.read("mass", physics.payload_mass.mean, kMass);
  map.read("spread", physics.payload_mass.spread, kMass);
  if (const Node* position = map.get("position")) {
    const std::vector<double> place = config::read_numbers(*position, map.key_of("position"), 3, {-10.0, 10.0});
    std::copy(place.begin(), place.end(), physics.payload_position.begin());
  }
  map.finish();
}

void read_actuators(MapReader& in, ActuatorErrors& actuators, PhysicsErrors& physics) {
  MapReader map(child(in, "actuators"), in.key_of("actuators"));
  MapReader joints(child(map, "joints"), map.key_of("joints"));
  joints.read("delay", actuators.joint_delay, kDelay);
  joints.read("gain_error", actuators.joint_gain, kGain);
  read_spread(joints, "friction", "effort", physics.joint_friction, kFriction);
  joints.finish();
  MapReader base(child(map, "base"), map.key_of("base"));
  base.read("delay", actuators.base_delay, kDelay);
  read_spread(base, "gain_error", actuators.base_gain, kGain);
  base.finish();
  map.finish();
}

// Writers: a key only where its value is not the default's.
template <typename Value>
void put(Json& out, const char* key, const Value& value, const Value& standard) {
  if (value != standard) out[key] = value;
}

void put(Json& out, const char* key, Json map) {
  if (!map.is_null()) out[key] = std::move(map);
}

void put(Json& out, const char* key, const PoseSpread& spread) {
  Json map;
  put(map, "position", spread.position, 0.0);
  put(map, "rotation", spread.rotation, 0.0);
  put(out, key, std::move(map));
}

void put(Json& out, const char* key, const TwistSpread& spread) {
  Json map;
  put(map, "linear", spread.linear, 0.0);
  put(map, "angular", spread.angular, 0.0);
  put(out, key, std::move(map));
}

Json json_of(const JointSensing& joints) {
  Json out;
  put(out, "noise", joints.noise, 0.0);
  put(out, "velocity_noise", joints.velocity_noise, 0.0);
  put(out, "bias", joints.bias, 0.0);
  put(out, "delay", joints.delay, 0.0);
  return out;
}

Json json_of(const BaseSensing& base) {
  Json out, odometry;
  put(out, "noise", base.noise);
  put(out, "velocity_noise", base.velocity_noise);
  put(out, "bias", base.bias);
  put(out, "delay", base.delay, 0.0);
  put(odometry, "distance", base.odometry.distance, 0.0);
  put(odometry, "turn", base.odometry.turn, 0.0);
  put(odometry, "heading", base.odometry.heading, 0.0);
  put(odometry, "walk", base.odometry.walk);
  put(out, "odometry", std::move(odometry));
  return out;
}

Json json_of(const PoseSensing& poses) {
  Json out;
  if (poses.frame == SensingFrame::kBase) out["frame"] = "base";
  put(out, "noise", poses.noise);
  put(out, "velocity_noise", poses.velocity_noise);
  put(out, "resting_is_known", poses.resting_is_known, false);
  put(out, "bias", poses.bias);
  put(out, "delay", poses.delay, 0.0);
  return out;
}

void put(Json& out, const char* key, const char* mean, const Spread& spread, const Spread& standard) {
  Json map;
  put(map, mean, spread.mean, standard.mean);
  put(map, "spread", spread.spread, standard.spread);
  put(out, key, std::move(map));
}

Json json_of(const ActuatorErrors& actuators, const PhysicsErrors& physics) {
  Json out, joints, base;
  put(joints, "delay", actuators.joint_delay, 0.0);
  put(joints, "gain_error", actuators.joint_gain, 0.0);
  put(joints, "friction", "effort", physics.joint_friction, {});
  put(base, "delay", actuators.base_delay, 0.0);
  put(base, "gain_error", actuators.base_gain);
  put(out, "joints", std::move(joints));
  put(out, "base", std::move(base));
  return out;
}

}  // namespace

Disturbances read_disturbances(const Node& node, const std::string& key) {
  if (node.kind == Node::Kind::kScalar) {
    if (node.scalar == "none") return {};
    if (!node.scalar.ends_with(".yaml") && !node.scalar.ends_with(".yml")) {
      config::fail(
          node.mark, key,
          "found '" + node.scalar + "', expected none, a file.yaml, or a map such as {joints: {noise: 0.001}}");
    }
    const auto file = std::filesystem::path(node.mark.file).parent_path() / node.scalar;
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) config::fail(node.mark, key, "no such file: " + file.string());
    return read_disturbances(config::load_yaml(file), key);
  }
  Disturbances out;
  MapReader in(node, key);
  if (const Node* seed = in.get("seed"))
    out.seed = static_cast<std::uint64_t>(config::read_integer(*seed, in.key_of("seed"), 0, 0xffffffffLL));
  read_joints(in, out.joints);
  read_base(in, out.base);
  read_objects(in, out.objects, out.detection);
  MapReader goal(child(in, "goal"), in.key_of("goal"));
  read_poses(goal, out.goal);
  goal.finish();
  read_actuators(in, out.actuators, out.physics);
  read_payload(in, out.physics);
  read_spread(in, "floor", "friction", out.physics.floor_friction, kSpread);
  in.finish();
  return out;
}

Json to_json(const Disturbances& disturbances) {
  Json out = Json::object();
  if (!any(disturbances)) return out;
  const DetectionRule off;
  const DetectionRule& detection = disturbances.detection;
  put(out, "seed", disturbances.seed, std::uint64_t{0});
  put(out, "joints", json_of(disturbances.joints));
  put(out, "base", json_of(disturbances.base));
  Json objects = json_of(disturbances.objects);
  put(objects, "range", detection.range, off.range);
  put(objects, "detection", detection.detection, 0.0);
  put(objects, "known_at_start", detection.known_at_start, false);
  put(objects, "sensor", detection.sensor, off.sensor);
  put(out, "objects", std::move(objects));
  put(out, "goal", json_of(disturbances.goal));
  const PhysicsErrors usual;
  put(out, "actuators", json_of(disturbances.actuators, disturbances.physics));
  Json payload;
  put(payload, "mass", disturbances.physics.payload_mass.mean, 0.0);
  put(payload, "spread", disturbances.physics.payload_mass.spread, 0.0);
  if (!payload.is_null()) put(payload, "position", disturbances.physics.payload_position, usual.payload_position);
  put(out, "payload", std::move(payload));
  put(out, "floor", "friction", disturbances.physics.floor_friction, usual.floor_friction);
  return out;
}

}  // namespace moma
