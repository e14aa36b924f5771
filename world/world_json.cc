#include "world/world_json.h"

#include <cmath>
#include <limits>
#include <set>
#include <type_traits>

#include "controller/config/json_node.h"
#include "controller/config/object_file.h"
#include "controller/config/reader.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;
using config::Range;
using Json = nlohmann::ordered_json;

Json json_of(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }
Json json_of(const Vector6& v) { return Json(std::vector<double>(v.data(), v.data() + 6)); }
Json json_of(const Eigen::Quaterniond& q) { return Json::array({q.w(), q.x(), q.y(), q.z()}); }
Json json_of(const Configuration& c) {
  return Json{{"base", json_of(c.base)}, {"q", std::vector<double>(c.q.data(), c.q.data() + c.q.size())}};
}

/// In the order of Motion's alternatives.
enum class MotionKind { kStatic, kLinear, kPath, kCircle, kSpline };
constexpr auto words(Of<MotionKind>) {
  return std::to_array<std::string_view>({"static", "linear", "path", "circle", "spline"});
}
static_assert(std::variant_size_v<Motion> == words(Of<MotionKind>{}).size());

/// Returns the quaternion that reproduces R bit for bit if it is known, else the nearest.
Eigen::Quaterniond rotation_for_file(const Matrix3& R, const Eigen::Quaterniond& kept) {
  return kept.normalized().toRotationMatrix() == R ? kept : Eigen::Quaterniond(R);
}

Vector3 vector3(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 3);
  return {v[0], v[1], v[2]};
}

Vector6 vector6(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 6);
  return Eigen::Map<const Vector6>(v.data());
}

Eigen::Quaterniond quaternion(const Node& node, const std::string& key) {
  const std::vector<double> v = config::read_numbers(node, key, 4);
  Eigen::Quaterniond q(v[0], v[1], v[2], v[3]);
  if (!(std::abs(q.norm() - 1.0) < 1e-3)) config::fail(node.mark, key, "expected a unit quaternion [w, x, y, z]");
  return q;
}

std::vector<double> knot_times(MapReader& in) {
  const Node& node = in.require("times", "increasing times in seconds");
  std::vector<double> times = config::read_numbers(node, in.key_of("times"), -1);
  if (times.empty()) config::fail(node.mark, in.key_of("times"), "expected at least one time");
  for (std::size_t i = 1; i < times.size(); ++i)
    if (!(times[i] > times[i - 1])) config::fail(node.mark, in.key_of("times"), "expected increasing times");
  return times;
}

std::vector<Vector3> knot_positions(MapReader& in, std::size_t count) {
  const Node& node = in.require("positions", "one position for each time");
  const std::string key = in.key_of("positions");
  if (node.kind != Node::Kind::kSequence || node.items.size() != count)
    config::fail(node.mark, key, "expected a list of " + std::to_string(count) + " positions, one for each time");
  std::vector<Vector3> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(vector3(node.items[i], key + "[" + std::to_string(i) + "]"));
  return out;
}

Configuration configuration(const Node& node, const std::string& key) {
  MapReader in(node, key);
  Configuration out;
  out.base = vector3(in.require("base", "[x, y, phi]"), in.key_of("base"));
  const std::vector<double> q = config::read_numbers(in.require("q", "one value for each joint"), in.key_of("q"), -1);
  out.q = Eigen::Map<const VectorX>(q.data(), static_cast<Eigen::Index>(q.size()));
  in.finish();
  return out;
}

/// The position in a file is that at t = 0, so that a motion through knots must agree with it.
void check_start(const Node& node, const std::string& key, const Motion& motion, const Isometry& X_0) {
  const double gap = (evaluate(motion, X_0, 0.0).X.translation() - X_0.translation()).norm();
  if (!(gap < 1e-6))
    config::fail(node.mark, key + ".motion", "at t = 0 it is " + std::to_string(gap) + " m from the position given");
}

WorldGoal goal(const Node& node, const std::string& key) {
  MapReader in(node, key);
  WorldGoal out;
  const Vector3 position = vector3(in.require("position", "[x, y, z]"), in.key_of("position"));
  set_pose(out, position, quaternion(in.require("quaternion", "[w, x, y, z]"), in.key_of("quaternion")));
  if (const Node* motion = in.get("motion")) out.motion = motion_from_node(*motion, in.key_of("motion"));
  if (const Node* twist = in.get("twist")) {
    const Vector6 found = vector6(*twist, in.key_of("twist"));
    // A twist without a motion is constant; with a motion it repeats the motion's twist.
    if (std::holds_alternative<StaticMotion>(out.motion) && !found.isZero(0.0)) out.motion = LinearMotion{found};
  }
  check_start(node, key, out.motion, out.X_WG);
  in.finish();
  return out;
}

WorldObject object(const Node& node, const std::string& key) {
  MapReader in(node, key);
  WorldObject out;
  out.name = config::read_string(in.require("name", "a name"), in.key_of("name"));
  out.shape = config::read_shape(in, kPrimitiveShapes);
  const Vector3 position = vector3(in.require("position", "[x, y, z]"), in.key_of("position"));
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (const Node* q = in.get("quaternion")) rotation = quaternion(*q, in.key_of("quaternion"));
  set_pose(out, position, rotation);
  if (const Node* motion = in.get("motion")) out.motion = motion_from_node(*motion, in.key_of("motion"));
  if (const Node* velocity = in.get("velocity")) {
    const Vector6 found = vector6(*velocity, in.key_of("velocity"));
    if (std::holds_alternative<StaticMotion>(out.motion) && !found.isZero(0.0)) out.motion = LinearMotion{found};
  }
  in.read("noise", out.noise, 0, (1 << 24) - 1);
  check_start(node, key, out.motion, out.X_WO);
  in.finish();
  return out;
}

/// A list of [id, scale, fraction, mask].
std::shared_ptr<const Moves> moves(const Node& node, const std::string& key) {
  if (node.kind != Node::Kind::kSequence) config::fail(node.mark, key, "expected a list of moves");
  auto out = std::make_shared<Moves>();
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string at = key + "[" + std::to_string(i) + "]";
    const std::vector<double> v = config::read_numbers(node.items[i], at, 4);
    const auto whole = [](double x, double below) { return x >= 0.0 && x < below && x == std::floor(x); };
    if (!whole(v[0], 0x1p53) || !(v[1] > 0.0 && v[1] <= 1.0) || !(v[2] > 0.0 && v[2] <= 1.0) || !whole(v[3], 128.0))
      config::fail(
          node.items[i].mark, at,
          "expected [id, scale, fraction, mask]: whole numbers below 2^53 and 128, scale and fraction in (0, 1]");
    out->push_back({static_cast<std::uint64_t>(v[0]), v[1], v[2], static_cast<std::uint32_t>(v[3])});
  }
  return out;
}

Difficulty difficulty(const Node& node, const std::string& key) {
  MapReader in(node, key);
  Difficulty out;
  out.witness_clearance_m = out.narrowest_gap_m = std::numeric_limits<double>::quiet_NaN();
  in.read("goal_distance_m", out.goal_distance_m, Range::non_negative());
  in.read("objects", out.objects, 0, 1000000);
  in.read("witness_clearance_m", out.witness_clearance_m);
  in.read("blocked_fraction", out.blocked_fraction, {0.0, 1.0});
  in.read("narrowest_gap_m", out.narrowest_gap_m);
  in.finish();
  return out;
}

}  // namespace

Motion motion_from_node(const Node& node, const std::string& key) {
  MapReader in(node, key);
  auto kind = MotionKind::kStatic;
  in.require("kind", "static, linear, path, circle or spline");
  in.read_enum("kind", kind);
  Motion out;
  switch (kind) {
    case MotionKind::kStatic:
      break;
    case MotionKind::kLinear:
      out = LinearMotion{vector6(in.require("velocity", "[angular; linear], six numbers"), in.key_of("velocity"))};
      break;
    case MotionKind::kPath: {
      PathMotion path;
      path.times = knot_times(in);
      path.positions = knot_positions(in, path.times.size());
      if (const Node* list = in.get("quaternions")) {
        const std::string at = in.key_of("quaternions");
        if (list->kind != Node::Kind::kSequence || (!list->items.empty() && list->items.size() != path.times.size()))
          config::fail(list->mark, at, "expected one quaternion for each time");
        for (const Node& item : list->items) path.quaternions.push_back(quaternion(item, at));
      }
      out = std::move(path);
      break;
    }
    case MotionKind::kCircle: {
      CircleMotion circle;
      circle.center = vector3(in.require("center", "[x, y, z]"), in.key_of("center"));
      circle.axis = vector3(in.require("axis", "a direction [x, y, z]"), in.key_of("axis"));
      in.check(circle.axis.norm() > 1e-9, "axis", "expected a direction that is not zero");
      circle.rate = config::read_number(in.require("rate", "rad/s"), in.key_of("rate"));
      out = circle;
      break;
    }
    case MotionKind::kSpline: {
      SplineMotion spline;
      spline.times = knot_times(in);
      spline.positions = knot_positions(in, spline.times.size());
      out = std::move(spline);
      break;
    }
  }
  in.finish();
  return out;
}

Json to_json(const Motion& motion) {
  const auto list = [](const auto& values) {
    Json out = Json::array();
    for (const auto& value : values) out.push_back(json_of(value));
    return out;
  };
  const auto kind = to_string(static_cast<MotionKind>(motion.index()));
  return std::visit(
      [&](const auto& m) -> Json {
        using Kind = std::decay_t<decltype(m)>;
        if constexpr (std::is_same_v<Kind, StaticMotion>) {
          return {{"kind", kind}};
        } else if constexpr (std::is_same_v<Kind, LinearMotion>) {
          return {{"kind", kind}, {"velocity", json_of(m.V_W)}};
        } else if constexpr (std::is_same_v<Kind, PathMotion>) {
          return {{"kind", kind},
                  {"times", m.times},
                  {"positions", list(m.positions)},
                  {"quaternions", list(m.quaternions)}};
        } else if constexpr (std::is_same_v<Kind, CircleMotion>) {
          return {{"kind", kind}, {"center", json_of(m.center)}, {"axis", json_of(m.axis)}, {"rate", m.rate}};
        } else {
          return {{"kind", kind}, {"times", m.times}, {"positions", list(m.positions)}};
        }
      },
      motion);
}

Json to_json(const World& world) {
  Json objects = Json::array();
  for (const WorldObject& o : world.objects) {
    const int count = num_sizes(o.shape.kind);
    const Vector6 velocity = evaluate(o.motion, o.X_WO, 0.0).V_W;
    objects.push_back({{"name", o.name},
                       {"shape", to_string(o.shape.kind)},
                       {"size", std::vector<double>(o.shape.size.data(), o.shape.size.data() + count)},
                       {"position", json_of(Vector3(o.X_WO.translation()))},
                       {"quaternion", json_of(rotation_for_file(o.X_WO.linear(), o.file_rotation))},
                       {"velocity", json_of(velocity)},
                       {"motion", to_json(o.motion)}});
    if (o.noise >= 0) objects.back()["noise"] = o.noise;
  }
  const Difficulty& d = world.difficulty;
  const Vector6 twist = evaluate(world.goal.motion, world.goal.X_WG, 0.0).V_W;
  Json out = {{"index", world.index},
              {"seed", world.seed},
              {"family", world.family},
              {"robot", world.robot},
              {"start", json_of(world.start)},
              {"goal",
               {{"position", json_of(Vector3(world.goal.X_WG.translation()))},
                {"quaternion", json_of(rotation_for_file(world.goal.X_WG.linear(), world.goal.file_rotation))},
                {"twist", json_of(twist)},
                {"motion", to_json(world.goal.motion)}}},
              {"objects", std::move(objects)},
              {"witness", json_of(world.witness)},
              {"difficulty",
               {{"goal_distance_m", d.goal_distance_m},
                {"objects", d.objects},
                {"witness_clearance_m", d.witness_clearance_m},
                {"blocked_fraction", d.blocked_fraction},
                {"narrowest_gap_m", d.narrowest_gap_m}}}};
  if (world.moves != nullptr && !world.moves->empty()) out["moves"] = to_json(*world.moves);
  return out;
}

Json to_json(const Moves& moves) {
  Json out = Json::array();
  for (const Move& move : moves) out.push_back({move.id, move.scale, move.fraction, move.mask});
  return out;
}

World world_from_node(const Node& node, const std::string& key) {
  MapReader in(node, key);
  World out;
  unsigned long long index = 0;
  unsigned long long seed = 0;
  in.read("index", index);
  in.read("seed", seed);
  out.index = index;
  out.seed = seed;
  in.read("family", out.family);
  in.read("robot", out.robot);
  out.start = configuration(in.require("start", "{base, q}"), in.key_of("start"));
  out.goal = goal(in.require("goal", "{position, quaternion, ...}"), in.key_of("goal"));
  if (const Node* list = in.get("objects")) {
    const std::string at = in.key_of("objects");
    if (list->kind != Node::Kind::kSequence) config::fail(list->mark, at, "expected a list of objects");
    std::set<std::string> names;
    for (std::size_t i = 0; i < list->items.size(); ++i) {
      const std::string item = at + "[" + std::to_string(i) + "]";
      out.objects.push_back(object(list->items[i], item));
      if (!names.insert(out.objects.back().name).second)
        config::fail(list->items[i].mark, item + ".name", "the name '" + out.objects.back().name + "' is used twice");
    }
  }
  if (const Node* witness = in.get("witness"))
    out.witness = configuration(*witness, in.key_of("witness"));
  else
    out.witness = out.start;
  if (const Node* found = in.get("difficulty")) out.difficulty = difficulty(*found, in.key_of("difficulty"));
  if (const Node* found = in.get("moves")) out.moves = moves(*found, in.key_of("moves"));
  in.finish();
  if (out.witness.q.size() != out.start.q.size())
    in.fail_at("witness", "start has " + std::to_string(out.start.q.size()) + " joint values, witness " +
                              std::to_string(out.witness.q.size()));
  return out;
}

World world_from_json(const Json& json, const std::string& what) {
  return world_from_node(config::node_from_json(json, what), "");
}

}  // namespace moma
