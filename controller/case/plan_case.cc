#include "controller/case/plan_case.h"

#include <cmath>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "controller/case/sensed.h"
#include "controller/config/read_described.h"
#include "controller/config/write_described.h"

namespace moma {
namespace {
constexpr Range kSteps{0.0, 1e12};
constexpr About kDirectTime{.unit = "s", .text = "predicted time of the direct policy; negative: it fails"};
}  // namespace

constexpr void describe(auto& v, Of<GoingOn>) {
  v.member("commit", &GoingOn::commit, in_range(kSteps, "", "step at which a choice takes effect"));
  v.member("direct_time", &GoingOn::direct_time, kDirectTime);
  v.member("chosen", &GoingOn::chosen, {.text = "whether it is made, and waits for that step"});
}

constexpr void describe(auto& v, Of<Following>) {
  v.member("mark", &Following::mark, in_range(kSteps, "", "step of the last progress along the path"));
  v.member("mark_clock", &Following::mark_clock, non_negative("s", "the path's clock then"));
}

constexpr void describe(auto& v, Of<Stopping>) {
  v.member("stop_end", &Stopping::stop_end, in_range(kSteps, "", "step at which a stop has lasted long enough"));
  v.member("direct_time", &Stopping::direct_time, kDirectTime);
}

constexpr void describe(auto& v, Of<Choosing>) {
  v.member("stop_end", &Choosing::stop_end, in_range(kSteps, "", "step at which the choice began"));
  v.member("direct_time", &Choosing::direct_time, kDirectTime);
}

constexpr void describe(auto&, Of<GoingDirect>) {}

constexpr void describe(auto&, Of<SettingOut>) {}

// The members that stand beside `doing`, goal and path.
constexpr void describe(auto& v, Of<PlanState>) {
  using T = PlanState;
  v.inlined(&T::brief);
  v.member("steps", &T::steps, in_range(kSteps, "", "since the start or the goal's last jump"));
  v.member("next", &T::next, in_range(kSteps, "", "step of the next prediction"));
  v.member("next_onward", &T::next_onward,
           unless_default(in_range(kSteps, "", "step of the next search for a path on from the goal")));
  v.member("stagnations", &T::stagnations, in_range({0, 1e9}, "", "up to which nothing is news"));
  v.member("fresh", &T::fresh, {.text = "whether the direct policy's memory of detours is cleared"});
  v.member("known", &T::known, in_range({0, 1e9}, "", "objects that were seen in the step before"));
  v.member("former", &T::former, unless_default({.text = "whether the path leads to the goal before"}));
  v.member("missed", &T::missed, unless_default({.text = "whether the goal was passed and not reached"}));
  v.member("beside", &T::beside, unless_default(in_range({0, 1e9}, "", "steps beside the goal")));
  v.member("left", &T::left, unless_default({.text = "whether a path's last part was left to the policy"}));
  v.member("held", &T::held, unless_default({.text = "whether something held the robot off a path's end"}));
}

namespace {

using config::MapReader;
using config::Node;

struct StoredMotion {
  double start = 0.0, time = 0.0;
  std::optional<double> ramp;  // both, in files of simulation version 13 and before
  double rise = 0.0, fall = 0.0;
  std::vector<double> change;
};

constexpr void describe(auto& v, Of<StoredMotion>) {
  using T = StoredMotion;
  constexpr About kTime{.unit = "s", .range = Range::non_negative(), .required = true};
  v.member("start", &T::start, kTime);
  v.member("time", &T::time, kTime);
  v.member("ramp", &T::ramp, non_negative("s", "both of the following"));
  v.member("rise", &T::rise, non_negative("s", "time of speeding up"));
  v.member("fall", &T::fall, non_negative("s", "time of slowing down"));
  v.member("change", &T::change, {.required = true, .text = "x, y, phi of the base, and each joint"});
}

WholeConfiguration read_configuration(const Node& node, const std::string& key, const RobotModel& model) {
  const std::vector<double> v = config::read_numbers(node, key, 3 + model.num_joints());
  return Eigen::Map<const VectorX>(v.data(), static_cast<Eigen::Index>(v.size()));
}

Isometry read_goal(const Node& node, const std::string& key) {
  MapReader in(node, key);
  const Isometry X = read_pose(in);
  in.finish();
  return X;
}

Json numbers(const WholeConfiguration& c) {
  return config::description::list_to_json({c.data(), static_cast<std::size_t>(c.size())});
}

Json pose(const Isometry& X) {
  Json json = Json::object();
  write_pose(X, json);
  return json;
}

void read_path(const Node& node, const std::string& key, const RobotModel& model, Path& path) {
  MapReader in(node, key);
  path.origin =
      read_configuration(in.require("origin", "a value for x, y, phi and each joint"), in.key_of("origin"), model);
  path.X_WG = read_goal(in.require("goal", "a pose"), in.key_of("goal"));
  in.read("clearance", path.clearance, Range::non_negative());
  in.read("clearance_at_goal", path.kept_at_goal, Range::non_negative());
  in.read("passes", path.pass, Range::non_negative());
  if (const Node* next = in.get("next_goal")) path.X_WN = read_goal(*next, in.key_of("next_goal"));
  in.require("duration", "its time in seconds");
  in.read("duration", path.duration, Range::non_negative());
  const Node& motions = in.require("motions", "a list of motions");
  const std::string list = in.key_of("motions");
  if (motions.kind != Node::Kind::kSequence || motions.items.empty() || motions.items.size() > Path::kMostMotions)
    config::fail(motions.mark, list, "expected a list of 1 to " + std::to_string(Path::kMostMotions) + " motions");
  for (const Node& item : motions.items) {
    const std::string at = list + "[" + std::to_string(path.count) + "]";
    StoredMotion stored;
    config::read_described(item, at, stored);
    if (static_cast<int>(stored.change.size()) != 3 + model.num_joints())
      config::fail(item.mark, at + ".change",
                   "found " + std::to_string(stored.change.size()) + " numbers, expected " +
                       std::to_string(3 + model.num_joints()) + ": x, y, phi of the base, and each joint");
    if (stored.ramp) stored.rise = stored.fall = *stored.ramp;
    if (!(stored.rise + stored.fall <= stored.time * (1.0 + 1e-9)))
      config::fail(item.mark, at, "expected rise + fall to be no more than `time`");
    path.add({stored.start,
              {stored.time, stored.rise, stored.fall},
              Eigen::Map<const VectorX>(stored.change.data(), static_cast<Eigen::Index>(stored.change.size()))});
  }
  in.finish();
}

Json to_json(const Path& path) {
  Json motions = Json::array();
  for (int k = 0; k < path.count; ++k) {
    const PathPart& motion = path.motions[static_cast<std::size_t>(k)];
    motions.push_back({{"start", motion.start},
                       {"time", motion.motion.time},
                       {"rise", motion.motion.rise},
                       {"fall", motion.motion.fall},
                       {"change", numbers(motion.change)}});
  }
  Json json = {{"origin", numbers(path.origin)},
               {"motions", std::move(motions)},
               {"duration", path.duration},
               {"clearance", path.clearance},
               {"goal", pose(path.X_WG)}};
  if (path.passes()) {
    json["passes"] = path.pass;
    json["next_goal"] = pose(path.X_WN);
  }
  if (std::isfinite(path.kept_at_goal)) json["clearance_at_goal"] = path.kept_at_goal;
  return json;
}

}  // namespace

PlanState read_plan_state(const Node& node, const std::string& key, const RobotModel& model) {
  MapReader in(node, key);
  PlanState state;
  state.path.origin = WholeConfiguration::Zero(3 + model.num_joints());
  config::read_members(in, state);
  in.check(!state.brief.going_on || state.brief.mode == PlanMode::kDirect, "going_on", "only the mode direct goes on");
  // Files of simulation version 10 and before have the members of all that a robot can be doing.
  const std::size_t doing = state.brief.going_on ? kGoingOn : static_cast<std::size_t>(state.brief.mode);
  [&]<std::size_t... k>(std::index_sequence<k...>) {
    const auto read = [&](std::size_t index, auto alternative) {
      config::read_members(in, alternative);
      if (index == doing) state.doing = alternative;
    };
    (read(k, std::variant_alternative_t<k, Doing>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Doing>>{});
  for (const char* key_of_12 : {"left_path", "start", "detour", "time_detour"}) in.get(key_of_12);
  if (const Node* goal = in.get("goal")) {
    state.X_WG = read_goal(*goal, in.key_of("goal"));
    state.has_goal = true;
  }
  if (const Node* path = in.get("path")) read_path(*path, in.key_of("path"), model, state.path);
  in.check(state.brief.mode != PlanMode::kFollow || state.path.count > 0, "mode", "follow needs a path");
  const auto* going_on = std::get_if<GoingOn>(&state.doing);
  in.check(going_on == nullptr || !going_on->chosen || state.path.count > 0, "chosen", "a choice needs a path");
  in.finish();
  return state;
}

Json to_json(const PlanState& state) {
  Json json = config::write_described(state);
  std::visit([&](const auto& doing) { config::write_members(doing, json); }, state.doing);
  if (state.has_goal) json["goal"] = pose(state.X_WG);
  if (state.path.count > 0) json["path"] = to_json(state.path);
  return json;
}

}  // namespace moma
