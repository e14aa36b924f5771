#pragma once

#include <algorithm>
#include <limits>
#include <string_view>
#include <type_traits>

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/describe/kinds.h"
#include "controller/step.h"

namespace moma {

// The description of what crosses the border of a controller (describe/describe.h). Processes, shared libraries, Python
// and case files have it from here: a sensed quantity is its member in step.h and its line here. A member without a
// line does not compile.

constexpr void describe(auto& v, Of<ObjectCovariance>) {
  using T = ObjectCovariance;
  v.member("position", &T::position_W,
           {.unit = "m^2", .required = true, .text = "covariance of the origin's position"});
  v.member("velocity", &T::velocity_W,
           {.unit = "(m/s)^2", .required = true, .text = "covariance of the linear velocity"});
}

constexpr void describe(auto& v, Of<ObjectState>) {
  using T = ObjectState;
  v.member("pose", &T::X_WO, {});
  v.member("twist", &T::V_WO_W, quantity("rad/s, m/s", "[angular; linear], at the object's origin"));
  v.member("visible", &T::visible, unless_default({.text = "where it is not, the rest means nothing"}));
  v.member("covariance", &T::covariance, {.text = "as a tracker states it of this measurement"});
}

constexpr void describe(auto& v, Of<GoalState>) {
  using T = GoalState;
  v.member("pose", &T::X_WG, {.required = true});
  v.member("twist", &T::V_WG_W, quantity("rad/s, m/s", "[angular; linear], the goal's own; 0 where it stands still"));
  v.member("stop", &T::stop, unless_default({.text = "where it is not, the hand passes through on its way on"}));
  v.member(
      "free", &T::free,
      unless_default(in_range(
          {0.0, 1.0}, "", "1: the rotation about, or the place along, this axis of the goal is free; rx ry rz x y z")));
}

constexpr void describe(auto& v, Of<Carried>) {
  using T = Carried;
  v.member("object", &T::object, {.range = {0.0, 1e6}, .required = true, .text = "its index among the objects"});
  v.member("pose", &T::X_EO, {.required = true});
  v.member("support", &T::support,
           unless_default(in_range(
               {-2.0, 1e6}, "", "index of the object that it has not been lifted clear of; -2: the floor, -1: none")));
  v.member("touch", &T::touch,
           {.range = {-1.0, 1e6},
            .written = Written::kUnlessDefault,
            .text = "indices of robot shapes that it may touch beside those of the hand; -1: none"});
}

constexpr void describe(auto& v, Of<Observation>) {
  using T = Observation;
  v.member("time", &T::time,
           {.unit = "s",
            .written = Written::kUnlessDefault,
            .text = "since the start of the motion; where a period was missed, later by two"});
  v.member("base", &T::base, quantity("m, m, rad", "x, y, phi"));
  v.member("q", &T::q, {.unit = "rad or m", .per = Per::kJoint, .required = true, .text = "joint positions"});
  v.member("qdot", &T::qdot,
           {.unit = "rad/s or m/s", .per = Per::kVelocity, .text = "measured velocities, base first"});
  v.member("goal", &T::goal, {.required = true, .text = "a pose, its twist and what it asks for"});
  v.member("next", &T::next, {.text = "the goal after it; where none is told, it is the last one as far as is known"});
  v.member("upright", &T::upright, {.text = "path constraint of the whole motion"});
  v.member("carried", &T::carried, {.text = "the object in the hand, which moves with it; its pose is in E"});
  v.member("objects", &T::objects, {.text = "in the order of the reset"});
}

/// Copies `from`, except the objects that `to` has no room for. No allocation if the joints are as many.
inline void copy_observation(const Observation& from, Observation& to) noexcept {
  for_members<Observation>([&](std::string_view, auto pointer, const About&) {
    const auto& seen = from.*pointer;
    if constexpr (is_std_vector<std::remove_cvref_t<decltype(seen)>>)
      std::copy_n(seen.begin(), std::min(seen.size(), (to.*pointer).size()), (to.*pointer).begin());
    else
      to.*pointer = seen;
  });
}

/// Members of StepResult that a foreign controller may answer beside its command.
struct Details {};

constexpr void describe(auto& v, Of<Details>) {
  using T = StepResult;
  constexpr Range kCount{0.0, 1e9};
  v.member("status", &T::status, {.text = "of the problem as it was posed"});
  v.member("fallback", &T::fallback, {.text = "what replaced its solution"});
  v.member("slack", &T::slack, {.text = "of the task"});
  v.member("least_distance", &T::least_distance,
           in_range({std::numeric_limits<double>::lowest(), std::numeric_limits<double>::infinity()}, "m",
                    "to an object, as the controller sees it"));
  v.member("rows", &T::rows, in_range(kCount, "", "of the problem"));
  v.member("active_rows", &T::active_rows, in_range(kCount, "", "of these and of bounds, at their limit"));
  v.member("iterations", &T::iterations, in_range(kCount, "", "of the solver"));
}

constexpr void describe(auto& v, Of<StepResult>) {
  using T = StepResult;
  v.member(
      "command", &T::command,
      {.unit = "rad/s or m/s", .per = Per::kVelocity, .text = "velocities for the next control period, base first"});
  describe(v, Of<Details>{});
  v.member("error", &T::error, quantity("rad, m", "[rotation vector; position] from E to the goal"));
  v.member("error_norm", &T::error_norm, {.text = "clamped, as used in the weights"});
  v.member("manipulability", &T::manipulability, {});
  v.member("kept", &T::kept, {.text = "share of the QP's command that the check of braking kept"});
  v.member("latency_base", &T::latency_base,
           quantity("s", "from a command to the base's velocity measured of it, as identified; -1: not looked for"));
  v.member("latency_joints", &T::latency_joints, quantity("s", "the same of the joints"));
  v.member("escape", &T::escape, {.text = "what was remembered of detours when the step began"});
  v.member("plan", &T::plan, {.text = "of looking ahead, when the step began"});
  v.member("solve_seconds", &T::solve_seconds, quantity("s", "0 unless timing was asked for"));
}

static_assert(is_complete<ObjectCovariance>() && is_complete<GoalState>() && is_complete<Observation>() &&
              is_complete<StepResult>());
// std::optional defeats is_complete(): this compiles as long as these are all members.
inline void all_members_of(const ObjectState& state) {
  [[maybe_unused]] const auto& [pose, twist, visible, covariance, box, seen] = state;  // the last two stay inside
}

}  // namespace moma
