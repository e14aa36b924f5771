#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "controller/describe/describe.h"
#include "controller/escape_state.h"
#include "controller/lookahead/plan_brief.h"
#include "controller/status.h"

namespace moma {

/// Record of one control step: the state *before* the step's command acts.
struct Sample {
  double t = 0.0;
  Vector3 base = Vector3::Zero();
  VectorX q;
  VectorX qdot;  ///< measured
  VectorX command;
  Vector6 error = Vector6::Zero();  ///< true error [e_R; e_p]
  Vector6 slack = Vector6::Zero();
  double manipulability = 0.0;
  double least_distance = std::numeric_limits<double>::infinity();
  StepStatus status = StepStatus::kSolved;
  Fallback fallback = Fallback::kNone;
  int active_rows = 0;
  EscapeState escape;   ///< the controller's memory of detours at the start of the step
  PlanBrief plan;       ///< mode and reason of the look-ahead at the start of the step; default without one
  VectorX object_time;  ///< times of the motions of the objects that give way, in their order
};

struct SampleColumn {
  std::string_view parts = "";  ///< of a vector: "x y phi" for base_x, base_y, base_phi; "" numbers them from 0
  std::string_view unit = "";
  std::string_view text = "";

  /// For visitors that need only unit and text.
  constexpr operator About() const { return {.unit = unit, .text = text}; }  // NOLINT(google-explicit-constructor)
};

constexpr void describe(auto& v, Of<Sample>) {
  using S = Sample;
  v.member("t", &S::t, SampleColumn{.unit = "s", .text = "time since the start"});
  v.member("base", &S::base,
           SampleColumn{.parts = "x y phi", .unit = "m, m, rad", .text = "pose of the base in the world"});
  v.member("q", &S::q, SampleColumn{.unit = "rad or m", .text = "positions of the joints"});
  v.member("qdot", &S::qdot, SampleColumn{.unit = "SI, per s", .text = "measured velocities of base and joints"});
  v.member("command", &S::command,
           SampleColumn{.unit = "SI, per s", .text = "commanded velocities of base and joints"});
  v.member("error", &S::error,
           SampleColumn{.unit = "rad, then m", .text = "true error of the end effector: rotation, then position"});
  v.member("slack", &S::slack, SampleColumn{.unit = "rad/s, then m/s", .text = "slack of the QP's tracking rows"});
  v.member("manipulability", &S::manipulability, SampleColumn{.text = "translational manipulability"});
  v.member("least_distance", &S::least_distance,
           SampleColumn{.unit = "m", .text = "least sensed distance to an object; infinite if none was in range"});
  v.member("status", &S::status, SampleColumn{.text = "status of the QP in the step"});
  v.member("fallback", &S::fallback, SampleColumn{.text = "stage of the fallback that gave the command"});
  v.member("active_rows", &S::active_rows, SampleColumn{.text = "active rows of the QP"});
  v.member("escape", &S::escape, SampleColumn{.text = "memory of detours at the start of the step"});
  v.member("plan", &S::plan, SampleColumn{.text = "mode and reason of the look-ahead at the start of the step"});
  v.member("object_time", &S::object_time,
           SampleColumn{.unit = "s", .text = "times of the motions of the objects that give way to the robot"});
}

using Trace = std::vector<Sample>;

}  // namespace moma
