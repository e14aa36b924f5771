#pragma once

#include <numbers>

#include "world/scenario/distribution.h"

namespace moma {

/// Start and witness: the keys that all families share. The robot starts at the origin with the arm at `ready`. A fixed
/// base stays there; `distance`, `direction` and the headings are for mobile bases.
struct Placement {
  using Uniform = Distribution::Uniform;
  Distribution start_heading{Uniform{-std::numbers::pi, std::numbers::pi}};  ///< [rad]
  Distribution distance{Uniform{0.5, 4.0}};                                  ///< [m]
  Distribution direction{Uniform{-std::numbers::pi, std::numbers::pi}};      ///< [rad]
  Distribution heading{Uniform{-std::numbers::pi, std::numbers::pi}};        ///< [rad]
  double limit_margin = 0.1;      ///< [rad or m]; a quarter of the joint's range at most
  double tip_height = 0.1;        ///< [m]
  double floor_clearance = 0.02;  ///< [m]
  double self_clearance = 0.01;   ///< [m]
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<Placement>) {
  using T = Placement;
  v.member("start_heading", &T::start_heading, {.unit = "rad", .text = "heading of the base at the start"});
  v.member("distance", &T::distance,
           {.unit = "m", .range = Range::non_negative(), .text = "distance from the start to the witness's base"});
  v.member("direction", &T::direction, {.unit = "rad", .text = "direction of that line in the world"});
  v.member("heading", &T::heading, {.unit = "rad", .text = "heading of the witness's base"});
  v.member("limit_margin", &T::limit_margin,
           {.unit = "rad or m",
            .range = Range::non_negative(),
            .text = "distance of the witness's joints from their limits, at most a quarter of their range"});
  v.member("tip_height", &T::tip_height, {.unit = "m", .text = "least height of the goal"});
  v.member(
      "floor_clearance", &T::floor_clearance,
      {.unit = "m", .range = Range::non_negative(), .text = "distance of the witness's moving shapes from the floor"});
  v.member("self_clearance", &T::self_clearance,
           {.unit = "m", .range = Range::non_negative(), .text = "distance between the witness's own shapes"});
}

}  // namespace moma
