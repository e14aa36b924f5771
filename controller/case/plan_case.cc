#include "controller/case/plan_case.h"

#include <concepts>
#include <utility>
#include <variant>
#include <vector>

#include "controller/case/sensed.h"
#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "controller/describe/complete.h"

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
  v.member("former", &Following::former, unless_default({.text = "whether the path leads to the goal before"}));
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

// The members that stand beside `doing` and path.
constexpr void describe(auto& v, Of<PlanState>) {
  using T = PlanState;
  v.inlined(&T::brief);
  v.member("steps", &T::steps, in_range(kSteps, "", "since the start or the goal's last jump"));
  v.member("next", &T::next, in_range(kSteps, "", "step of the next prediction"));
  v.member("next_onward", &T::next_onward,
           unless_default(in_range(kSteps, "", "step of the next search for a path on from the goal")));
  v.member("stagnations", &T::stagnations, in_range({0, 1e9}, "", "up to which nothing is news"));
  v.member("fresh", &T::clears_detours, {.text = "whether the direct policy's memory of detours is cleared"});
  v.member("rate", &T::rate, unless_default(share("rate of the path's clock in the step before")));
  v.member("known", &T::known, in_range({0, 1e9}, "", "objects that were seen in the step before"));
  v.member("missed", &T::missed, unless_default({.text = "whether the goal was passed and not reached"}));
  v.member("beside", &T::steps_beside, unless_default(in_range({0, 1e9}, "", "steps beside the goal")));
  v.member("left", &T::left_last_part, unless_default({.text = "whether a path's last part was left to the policy"}));
  v.member("held", &T::held_off, unless_default({.text = "whether something held the robot off a path's end"}));
  v.written_where([](const T& state) { return state.has_goal; },
                  [](auto& g) { g.member("goal", &T::X_WG, {.text = "in the step before"}); });
}

static_assert(is_complete<GoingOn>() && is_complete<Following>() && is_complete<Stopping>() && is_complete<Choosing>());
// This compiles as long as these are all members: read_plan_state() reads those that the description leaves out.
[[maybe_unused]] static void all_members_of(const PlanState& state) {
  [[maybe_unused]] const auto& [brief, doing, steps, next, next_onward, stagnations, clears_detours, rate, known,
                                has_goal, X_WG, path, missed, steps_beside, left_last_part, held_off] = state;
}

constexpr void describe(auto& v, Of<Trapezoid>) {
  v.member("time", &Trapezoid::time, {.unit = "s", .range = Range::non_negative(), .required = true});
  v.member("rise", &Trapezoid::rise, non_negative("s", "time of speeding up"));
  v.member("fall", &Trapezoid::fall, non_negative("s", "time of slowing down"));
}

constexpr void describe(auto& v, Of<PathPart>) {
  v.member("start", &PathPart::start, {.unit = "s", .range = Range::non_negative(), .required = true});
  v.inlined(&PathPart::motion);
  v.member("change", &PathPart::change, {.required = true});
}

// The members that stand beside its motions.
constexpr void describe(auto& v, Of<Path>) {
  using T = Path;
  v.member("origin", &T::origin, {.required = true});
  v.member("duration", &T::duration, {.unit = "s", .range = Range::non_negative(), .required = true});
  v.member("clearance", &T::clearance, non_negative("m", "distance from objects at rest"));
  v.member("clearance_at_goal", &T::kept_at_goal, unless_default(non_negative("m", "the same at the goal")));
  v.member("arm_clearance_at_goal", &T::arm_at_goal, unless_default(non_negative("m", "the same of all but the hand")));
  v.member("goal", &T::X_WG, {.required = true});
  v.member("meets", &T::meets, unless_default({.text = "whether a goal in motion was expected there"}));
  v.written_where([](const T& path) { return path.passes(); },
                  [](auto& g) {
                    g.member("passes", &T::pass, non_negative("s", "time at which E passes the goal"));
                    g.member("next_goal", &T::X_WN, {.text = "at which the path ends then"});
                  });
}

std::string accepted(Of<Isometry>, const About& /*about*/) { return "a pose"; }

std::string accepted(Of<WholeConfiguration>, const About& /*about*/) {
  return "a value for x, y, phi of the base, and each joint";
}

void read_value(const config::Node& node, const std::string& key, Isometry& X, const About& /*about*/) {
  config::MapReader in(node, key);
  X = read_pose(in);
  in.finish();
}

template <std::same_as<Isometry> T>
Json write_value(const T& X, const About& /*about*/) {
  Json json = Json::object();
  write_pose(X, json);
  return json;
}

void read_value(const config::Node& node, const std::string& key, WholeConfiguration& c, const About& /*about*/) {
  const std::vector<double> v = config::read_numbers(node, key, -1);
  if (v.size() > static_cast<std::size_t>(c.MaxRowsAtCompileTime))
    config::fail(node.mark, key, "found " + config::found_text(node) + ", more than any robot has");
  c = Eigen::Map<const VectorX>(v.data(), static_cast<Eigen::Index>(v.size()));
}

template <std::same_as<WholeConfiguration> T>
Json write_value(const T& c, const About& /*about*/) {
  return config::description::list_to_json({c.data(), static_cast<std::size_t>(c.size())});
}

namespace {

using config::MapReader;
using config::Node;

void read_path(const Node& node, const std::string& key, const RobotModel& model, Path& path) {
  MapReader in(node, key);
  config::read_members(in, path);
  const auto check_size = [&](const WholeConfiguration& c, const MapReader& of, const char* name) {
    const Eigen::Index wanted = 3 + model.num_joints();
    of.check(c.size() == wanted, name,
             "found " + std::to_string(c.size()) + " numbers, expected " + std::to_string(wanted) +
                 ": x, y, phi of the base, and each joint");
  };
  check_size(path.origin, in, "origin");
  const Node& motions = in.require("motions", "a list of motions");
  in.check(!motions.items.empty() && motions.items.size() <= Path::kMostMotions, "motions",
           "expected a list of 1 to " + std::to_string(Path::kMostMotions) + " motions");
  config::for_items(motions, in.key_of("motions"), "a list of motions", [&](const Node& item, const std::string& at) {
    MapReader motion(item, at);
    PathPart part;
    motion.read("ramp", part.motion.rise, Range::non_negative());  // both, in files of simulation version 13 and before
    part.motion.fall = part.motion.rise;
    config::read_members(motion, part);
    motion.finish();
    check_size(part.change, motion, "change");
    if (!(part.motion.rise + part.motion.fall <= part.motion.time * (1.0 + 1e-9)))
      motion.fail("expected rise + fall to be no more than `time`");
    path.add(part);
  });
  in.finish();
}

Json to_json(const Path& path) {
  Json json = config::write_described(path);
  for (int k = 0; k < path.count; ++k)
    json["motions"].push_back(config::write_described(path.motions[static_cast<std::size_t>(k)]));
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
  state.has_goal = in.get("goal") != nullptr;
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
  if (state.path.count > 0) json["path"] = to_json(state.path);
  return json;
}

}  // namespace moma
