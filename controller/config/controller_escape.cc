#include "controller/config/controller_escape.h"

#include "controller/config/json_node.h"

namespace moma::config {
namespace {

// The map under `name`; nullptr where there is none, or the word none.
const Node* map_under(MapReader& in, std::string_view name) {
  const Node* node = in.get(name);
  const bool none = node != nullptr && node->kind == Node::Kind::kScalar && node->scalar == "none";
  return none ? nullptr : node;
}

}  // namespace

void read_escape(MapReader& in, EscapeParams& e) {
  const Node* node = map_under(in, "escape");
  if (node == nullptr) return;
  MapReader m(*node, in.key_of("escape"));
  e.enabled = true;
  m.read("enabled", e.enabled);
  m.read("scale", e.scale, Range::non_negative());
  m.read("progress", e.progress, Range::positive());
  m.read("patience", e.patience, Range::positive());
  m.read("traffic_patience", e.traffic_patience, Range::positive());
  m.read("position", e.position, Range::non_negative());
  m.read("orientation", e.orientation, Range::non_negative());
  m.read("side_distance", e.side_distance, Range::positive());
  m.read("angle", e.angle, Range::non_negative());
  m.read("length", e.length, Range::positive());
  m.read("growth", e.growth, Range::non_negative());
  m.read("max_length", e.max_length, Range::positive());
  m.read("duration", e.duration, Range::positive());
  m.read("reached", e.reached, Range::non_negative());
  m.read("slack_factor", e.slack_factor, Range::positive());
  if (const Node* posture = m.get("posture")) {
    MapReader p(*posture, m.key_of("posture"));
    p.read("weight", e.posture_weight, Range::non_negative());
    p.read("gain", e.posture_gain, Range::non_negative());
    p.finish();
  }
  if (const Node* around = map_under(m, "around")) {
    MapReader p(*around, m.key_of("around"));
    e.around.enabled = true;
    p.read("clearance", e.around.clearance, Range::non_negative());
    p.read("reach", e.around.reach, Range::non_negative());
    p.read("passed", e.around.passed, Range::positive());
    p.read("duration", e.around.duration, Range::positive());
    p.finish();
  }
  m.finish();
}

void read_vortex(MapReader& in, VortexParams& v) {
  const Node* node = map_under(in, "vortex");
  if (node == nullptr) return;
  MapReader m(*node, in.key_of("vortex"));
  v.enabled = true;
  m.read("gain", v.gain, Range::non_negative());
  m.read("distance", v.distance, Range::positive());
  m.read_enum<VortexWhen>("when", v.when, {{"stagnated", VortexWhen::kStagnated}, {"always", VortexWhen::kAlways}});
  m.finish();
}

EscapeState read_escape_state(const Node& node, const std::string& key) {
  EscapeState state;
  MapReader in(node, key);
  in.read("best", state.best);
  in.read("idle", state.idle, Range::non_negative());
  in.read("stagnations", state.stagnations, 0, 1000000000);
  in.read("side", state.side, -1, 1);
  in.read("detour", state.detour);
  in.read("around", state.around);
  in.read("remaining", state.remaining);
  if (const Node* target = in.get("target")) {
    const std::vector<double> p = read_numbers(*target, in.key_of("target"), 3);
    state.target_W << p[0], p[1], p[2];
  }
  in.read("circulation", state.circulation, -1, 1);
  in.finish();
  return state;
}

nlohmann::ordered_json to_json(const EscapeState& s) {
  return {{"best", s.best},
          {"idle", s.idle},
          {"stagnations", s.stagnations},
          {"side", s.side},
          {"detour", s.detour},
          {"around", s.around},
          {"remaining", s.remaining},
          {"target", {s.target_W.x(), s.target_W.y(), s.target_W.z()}},
          {"circulation", s.circulation}};
}

nlohmann::ordered_json to_json(const EscapeParams& e) {
  nlohmann::ordered_json json = {
      {"enabled", e.enabled},
      {"scale", number_to_json(e.scale)},
      {"progress", number_to_json(e.progress)},
      {"patience", number_to_json(e.patience)},
      {"traffic_patience", number_to_json(e.traffic_patience)},
      {"position", number_to_json(e.position)},
      {"orientation", number_to_json(e.orientation)},
      {"side_distance", number_to_json(e.side_distance)},
      {"angle", number_to_json(e.angle)},
      {"length", number_to_json(e.length)},
      {"growth", number_to_json(e.growth)},
      {"max_length", number_to_json(e.max_length)},
      {"duration", number_to_json(e.duration)},
      {"reached", number_to_json(e.reached)},
      {"slack_factor", number_to_json(e.slack_factor)},
      {"posture", {{"weight", number_to_json(e.posture_weight)}, {"gain", number_to_json(e.posture_gain)}}}};
  if (e.around.enabled) {  // off, nothing: the keys of trials without it stay what they were
    json["around"] = {{"clearance", number_to_json(e.around.clearance)},
                      {"reach", number_to_json(e.around.reach)},
                      {"passed", number_to_json(e.around.passed)},
                      {"duration", number_to_json(e.around.duration)}};
  }
  return json;
}

nlohmann::ordered_json to_json(const VortexParams& v) {
  if (!v.enabled) return "none";
  return {{"gain", number_to_json(v.gain)},
          {"distance", number_to_json(v.distance)},
          {"when", v.when == VortexWhen::kAlways ? "always" : "stagnated"}};
}

}  // namespace moma::config
