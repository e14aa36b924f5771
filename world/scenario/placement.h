#pragma once

#include <nlohmann/json.hpp>
#include <numbers>

#include "world/scenario/distribution.h"

namespace moma {

/// Where start and witness are: the keys that all families share. The robot starts at the origin, arm at `ready`.
/// A fixed base stays there; `distance`, `direction` and the headings are for mobile ones.
struct Placement {
  using Uniform = Distribution::Uniform;
  Distribution start_heading{Uniform{-std::numbers::pi, std::numbers::pi}};  ///< [rad]
  Distribution distance{Uniform{0.5, 4.0}};                                  ///< start to witness base [m]
  Distribution direction{Uniform{-std::numbers::pi, std::numbers::pi}};      ///< of that line in W [rad]
  Distribution heading{Uniform{-std::numbers::pi, std::numbers::pi}};        ///< of the witness base [rad]
  double limit_margin = 0.1;      ///< witness joints keep from their limits [rad or m]; a quarter of the range at most
  double tip_height = 0.1;        ///< least height of the goal [m]
  double floor_clearance = 0.02;  ///< of the witness's moving shapes [m]
  double self_clearance = 0.01;   ///< of the witness's self-collision pairs [m]

  void read(config::MapReader& in);
  void write(nlohmann::ordered_json& out) const;
};

}  // namespace moma
