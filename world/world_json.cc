#include "world/world_json.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <set>

#include "controller/config/convex_hull.h"
#include "controller/config/json_node.h"
#include "controller/config/object_file.h"
#include "controller/config/read_described.h"
#include "controller/config/write_described.h"

namespace moma {

using config::MapReader;
using config::Node;

// Readers and writers of described structs call these for rotations, goals, objects and moves.
void read_value(const Node& node, const std::string& key, Eigen::Quaterniond& q, const About&);
void read_value(const Node& node, const std::string& key, WorldGoal& goal, const About&);
void read_value(const Node& node, const std::string& key, WorldObject& object, const About&);
void read_value(const Node& node, const std::string& key, Move& move, const About&);
template <std::same_as<Eigen::Quaterniond> Q>  // and nothing that converts to one
Json write_value(const Q& q, const About&) {
  return Json::array({q.w(), q.x(), q.y(), q.z()});
}
Json write_value(const WorldGoal& goal, const About&);
Json write_value(const WorldObject& object, const About&);

/// In the order of GoalState::free.
enum class Direction { kRx, kRy, kRz, kX, kY, kZ };
constexpr auto words(Of<Direction>) { return std::to_array<std::string_view>({"rx", "ry", "rz", "x", "y", "z"}); }

/// In the order of Motion's alternatives.
enum class MotionKind { kStatic, kLinear, kPath, kCircle, kSpline };
constexpr auto words(Of<MotionKind>) {
  return std::to_array<std::string_view>({"static", "linear", "path", "circle", "spline"});
}
static_assert(std::variant_size_v<Motion> == words(Of<MotionKind>{}).size());

constexpr void describe(auto&, Of<StaticMotion>) {}
constexpr void describe(auto& v, Of<LinearMotion>) { v.member("velocity", &LinearMotion::V_W, {.required = true}); }
constexpr void describe(auto& v, Of<PathMotion>) {
  v.member("times", &PathMotion::times, {.required = true});
  v.member("positions", &PathMotion::positions, {.required = true});
  v.member("quaternions", &PathMotion::quaternions, {});
}
constexpr void describe(auto& v, Of<CircleMotion>) {
  v.member("center", &CircleMotion::center, {.required = true});
  v.member("axis", &CircleMotion::axis, {.required = true});
  v.member("rate", &CircleMotion::rate, {.required = true});
}
constexpr void describe(auto& v, Of<SplineMotion>) {
  v.member("times", &SplineMotion::times, {.required = true});
  v.member("positions", &SplineMotion::positions, {.required = true});
}

constexpr void describe(auto& v, Of<Configuration>) {
  v.member("base", &Configuration::base, {.required = true});
  v.member("q", &Configuration::q, {.required = true});
}

constexpr void describe(auto& v, Of<Held>) {
  v.member("object", &Held::object, {.required = true, .text = "name of the object"});
  v.member("touch", &Held::touch, {.written = Written::kUnlessDefault, .text = "links that it may touch"});
}

/// The members that are written first.
constexpr void describe(auto& v, Of<World>) {
  using T = World;
  v.member("index", &T::index, {});
  v.member("seed", &T::seed, {});
  v.member("family", &T::family, {});
  v.member("robot", &T::robot, {});
  v.member("start", &T::start, {.required = true});
  v.member("upright", &T::upright, {});
  v.member("held", &T::held, {});
}

namespace {

/// Returns the quaternion that reproduces R bit for bit if it is known, else the nearest.
Eigen::Quaterniond rotation_for_file(const Matrix3& R, const Eigen::Quaterniond& kept) {
  return kept.normalized().toRotationMatrix() == R ? kept : Eigen::Quaterniond(R);
}

void check(const MapReader&, const StaticMotion&) {}
void check(const MapReader&, const LinearMotion&) {}
void check(const MapReader& in, const CircleMotion& circle) {
  in.check(circle.axis.norm() > 1e-9, "axis", "expected a direction that is not zero");
}
/// A motion through knots: a path or a spline.
template <class M>
void check(const MapReader& in, const M& motion) {
  in.check(!motion.times.empty(), "times", "expected at least one time");
  for (std::size_t i = 1; i < motion.times.size(); ++i)
    in.check(motion.times[i] > motion.times[i - 1], "times", "expected increasing times");
  in.check(motion.positions.size() == motion.times.size(), "positions",
           "expected a list of " + std::to_string(motion.times.size()) + " positions, one for each time");
  if constexpr (std::same_as<M, PathMotion>)
    in.check(motion.quaternions.empty() || motion.quaternions.size() == motion.times.size(), "quaternions",
             "expected one quaternion for each time");
}

/// The keys that goal and objects share: their pose at t = 0, which a motion through knots must agree with, and their
/// motion. A twist without a motion is constant; with a motion it repeats the motion's twist.
template <class T>
void read_placed(MapReader& in, T& out, Isometry T::*X_0, const char* twist, bool turned) {
  Vector3 position;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  config::description::read_any(in.require("position", "[x, y, z]"), in.key_of("position"), position, {}, {});
  if (turned) in.require("quaternion", "[w, x, y, z]");
  if (const Node* q = in.get("quaternion")) read_value(*q, in.key_of("quaternion"), rotation, {});
  set_pose(out, position, rotation);
  if (const Node* motion = in.get("motion")) out.motion = motion_from_node(*motion, in.key_of("motion"));
  if (const Node* given = in.get(twist)) {
    LinearMotion linear;
    config::description::read_any(*given, in.key_of(twist), linear.V_W, {}, {});
    if (std::holds_alternative<StaticMotion>(out.motion) && !linear.V_W.isZero(0.0)) out.motion = linear;
  }
  const double gap = (evaluate(out.motion, out.*X_0, 0.0).X.translation() - position).norm();
  if (!(gap < 1e-6))
    config::fail(in.mark(), in.key_of("motion"),
                 "at t = 0 it is " + std::to_string(gap) + " m from the position given");
}

/// Checks that start and goals take one object at rest at a time, and goals leave that one.
void check_carried(const World& world, const MapReader& in) {
  const auto check_taken = [&](const std::string& key, const std::string& path, const std::string& name) {
    const int object = find_object(world, name);
    if (object < 0) in.fail_at(key.c_str(), fmt::format("{}: no object has the name '{}'", path, name));
    if (!at_rest(world.objects[static_cast<std::size_t>(object)].motion, 0.0))
      in.fail_at(key.c_str(), fmt::format("{}: '{}' moves; expected an object at rest", path, name));
  };
  std::string held = world.held ? world.held->object : "";
  if (world.held) check_taken("held", "held.object", held);
  for (std::size_t i = 0; i <= world.further.size(); ++i) {
    const WorldGoal& goal = goal_of(world, i);
    if (goal.take.empty() && goal.leave.empty()) continue;
    const std::string key = world.further.empty() ? "goal" : "goals", goal_i = fmt::format("{}[{}]", key, i);
    if (!goal.stop) in.fail_at(key.c_str(), goal_i + ": expected stop: true where the hand takes or leaves an object");
    if (!goal.leave.empty() && (goal.leave != held || !goal.take.empty()))
      in.fail_at(key.c_str(), fmt::format("{}.leave: '{}' is not what the hand carries ({})", goal_i, goal.leave,
                                          held.empty() ? "nothing" : held));
    if (!goal.take.empty()) {
      check_taken(key, goal_i + ".take", goal.take);
      if (!held.empty()) in.fail_at(key.c_str(), fmt::format("{}.take: the hand already carries '{}'", goal_i, held));
    }
    held = goal.take;
  }
}

template <class T>
void write_placed(Json& json, const T& placed, const Isometry& X_0, const char* twist) {
  const auto list = [](const auto& v) { return Json(std::vector<double>(v.begin(), v.end())); };
  json["position"] = list(X_0.translation());
  json["quaternion"] = write_value(rotation_for_file(X_0.linear(), placed.file_rotation), {});
  json[twist] = list(evaluate(placed.motion, X_0, 0.0).V_W);
  json["motion"] = to_json(placed.motion);
}

}  // namespace

void read_value(const Node& node, const std::string& key, Eigen::Quaterniond& q, const About&) {
  const std::vector<double> v = config::read_numbers(node, key, 4);
  q = Eigen::Quaterniond(v[0], v[1], v[2], v[3]);
  if (!(std::abs(q.norm() - 1.0) < 1e-3)) config::fail(node.mark, key, "expected a unit quaternion [w, x, y, z]");
}

void read_value(const Node& node, const std::string& key, WorldGoal& goal, const About&) {
  MapReader in(node, key);
  read_placed(in, goal, &WorldGoal::X_WG, "twist", true);
  in.read("stop", goal.stop);
  std::vector<Direction> free;
  if (const Node* found = in.get("free")) config::description::read_any(*found, in.key_of("free"), free, {}, {});
  for (const Direction direction : free) goal.free[static_cast<Eigen::Index>(direction)] = 1.0;
  in.check(!goal.free.isOnes(0.0), "free", "expected a direction that is not free");
  if (const Node* name = in.get("take")) goal.take = config::read_string(*name, in.key_of("take"));
  if (const Node* name = in.get("leave")) goal.leave = config::read_string(*name, in.key_of("leave"));
  in.finish();
}

void read_value(const Node& node, const std::string& key, WorldObject& object, const About&) {
  MapReader in(node, key);
  object.name = config::read_string(in.require("name", "a name"), in.key_of("name"));
  object.shape = config::read_shape(in);
  in.check(
      !object.shape.hull || config::is_hull(*object.shape.hull), "triangles",
      "expected the surface of the vertices' convex hull, counter-clockwise seen from outside; without this key it is "
      "computed");
  read_placed(in, object, &WorldObject::X_WO, "velocity", false);
  in.read("noise", object.noise, 0, (1 << 24) - 1);
  if (const Node* yields = in.get("yields")) config::read_described(*yields, in.key_of("yields"), object.yields);
  in.finish();
}

void read_value(const Node& node, const std::string& key, Move& move, const About&) {
  const std::vector<double> v = config::read_numbers(node, key, 4);
  const auto whole = [](double x, double below) { return x >= 0.0 && x < below && x == std::floor(x); };
  if (!whole(v[0], 0x1p53) || !(v[1] > 0.0 && v[1] <= 1.0) || !(v[2] > 0.0 && v[2] <= 1.0) || !whole(v[3], 128.0))
    config::fail(
        node.mark, key,
        "expected [id, scale, fraction, mask]: whole numbers below 2^53 and 128, scale and fraction in (0, 1]");
  move = {static_cast<std::uint64_t>(v[0]), v[1], v[2], static_cast<std::uint32_t>(v[3])};
}

Json write_value(const WorldGoal& goal, const About&) {
  Json json = Json::object();
  write_placed(json, goal, goal.X_WG, "twist");
  if (!goal.stop) json["stop"] = false;
  for (int i = 0; i < 6; ++i)
    if (goal.free[i] != 0.0) json["free"].push_back(to_string(static_cast<Direction>(i)));
  if (!goal.take.empty()) json["take"] = goal.take;
  if (!goal.leave.empty()) json["leave"] = goal.leave;
  return json;
}

Json write_value(const WorldObject& object, const About&) {
  Json json = {{"name", object.name}};
  config::write_shape(object.shape, json);
  write_placed(json, object, object.X_WO, "velocity");
  if (object.noise >= 0) json["noise"] = object.noise;
  if (gives_way(object)) config::write_members(object.yields, json["yields"]);
  return json;
}

Motion motion_from_node(const Node& node, const std::string& key) {
  MapReader in(node, key);
  auto kind = MotionKind::kStatic;
  in.require("kind", "static, linear, path, circle or spline");
  in.read_enum("kind", kind);
  const std::array<Motion, words(Of<MotionKind>{}).size()> of_kind{StaticMotion{}, LinearMotion{}, PathMotion{},
                                                                   CircleMotion{}, SplineMotion{}};
  Motion motion = of_kind[static_cast<std::size_t>(kind)];
  std::visit(
      [&in](auto& read) {
        config::read_members(in, read);
        check(in, read);
      },
      motion);
  in.finish();
  return motion;
}

Json to_json(const Motion& motion) {
  Json json = {{"kind", to_string(static_cast<MotionKind>(motion.index()))}};
  std::visit([&](const auto& m) { config::write_members(m, json); }, motion);
  return json;
}

Json to_json(const World& world) {
  Json json = config::write_described(world);
  if (world.further.empty()) json["goal"] = write_value(world.goal, {});
  for (std::size_t i = 0; !world.further.empty() && i <= world.further.size(); ++i)
    json["goals"].push_back(write_value(goal_of(world, i), {}));
  Json& objects = json["objects"] = Json::array();
  for (const WorldObject& object : world.objects) objects.push_back(write_value(object, {}));
  json["witness"] = config::write_described(world.witness);
  json["difficulty"] = config::write_described(world.difficulty);
  if (world.moves != nullptr && !world.moves->empty()) json["moves"] = to_json(*world.moves);
  return json;
}

Json to_json(const Moves& moves) {
  Json json = Json::array();
  for (const Move& move : moves) json.push_back({move.id, move.scale, move.fraction, move.mask});
  return json;
}

World world_from_node(const Node& node, const std::string& key) {
  MapReader in(node, key);
  World out;
  config::read_members(in, out);
  if (out.upright && !(out.upright->axis.norm() > 1e-9)) in.fail_at("upright", "expected an axis that is not zero");
  if (const Node* several = in.get("goals")) {
    if (in.get("goal") != nullptr) in.fail_at("goals", "expected either goal or goals");
    config::description::read_any(*several, in.key_of("goals"), out.further, {}, {});
    if (out.further.empty()) in.fail_at("goals", "expected at least one goal");
    if (!out.further.back().stop) in.fail_at("goals", "expected a last goal with stop: true");
    out.goal = std::move(out.further.front());
    out.further.erase(out.further.begin());
  } else {
    read_value(in.require("goal", "{position, quaternion, ...}, or goals: a list of them"), in.key_of("goal"), out.goal,
               {});
    if (!out.goal.stop) in.fail_at("goal", "expected stop: true, since no other goal follows");
  }
  const auto read = [&in](const char* name, auto& value) {
    if (const Node* found = in.get(name)) config::description::read_any(*found, in.key_of(name), value, {}, {});
  };
  read("objects", out.objects);
  std::set<std::string> names;
  for (std::size_t i = 0; i < out.objects.size(); ++i)
    if (!names.insert(out.objects[i].name).second)
      config::fail(in.get("objects")->items[i].mark, in.key_of("objects") + "[" + std::to_string(i) + "].name",
                   "the name '" + out.objects[i].name + "' is used twice");
  out.witness = out.start;
  read("witness", out.witness);
  if (in.get("difficulty") != nullptr)
    out.difficulty.witness_clearance_m = out.difficulty.narrowest_gap_m = std::numeric_limits<double>::quiet_NaN();
  read("difficulty", out.difficulty);
  Moves moves;
  read("moves", moves);
  if (in.get("moves") != nullptr) out.moves = std::make_shared<const Moves>(std::move(moves));
  in.finish();
  check_carried(out, in);
  if (out.witness.q.size() != out.start.q.size())
    in.fail_at("witness", "start has " + std::to_string(out.start.q.size()) + " joint values, witness " +
                              std::to_string(out.witness.q.size()));
  return out;
}

World world_from_json(const Json& json, const std::string& what) {
  return world_from_node(config::node_from_json(json, what), "");
}

}  // namespace moma
