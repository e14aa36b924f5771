#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "world/scenario/object_mix.h"
#include "world/scenario/scene_builder.h"

namespace moma {

/// The straight way from start to goal.
struct Way {
  Vector3 from = Vector3::Zero();      ///< where it begins
  Vector3 forward = Vector3::UnitX();  ///< unit vector along it, level
  double length = 0.0;                 ///< [m]
  Vector3 left() const { return {-forward.y(), forward.x(), 0.0}; }
};

/// People about their own business: each walks at a pace of its own from one random way-point straight to the next,
/// and stands still at some of them for a while. No one looks out for the robot.
struct Walk {
  using Normal = Distribution::Normal;
  using Uniform = Distribution::Uniform;
  /// Pace [m/s]. Free walking speeds of pedestrians, mean and deviation: Weidmann, Transporttechnik der Fussgaenger,
  /// ETH Zurich, 1993.
  Distribution speed{Normal{1.34, 0.26}};
  Distribution radius{Uniform{0.2, 0.3}};    ///< of the standing capsule that is a person [m]
  Distribution height{Normal{1.7, 0.1}};     ///< total [m]
  double pause = 0.3;                        ///< part of the way-points where a person stops
  Distribution pause_time{Uniform{0.5, 4}};  ///< and stands for so long [s]
  double margin = 2.0;                       ///< way-points lie within this of the way [m]
  bool people = true;                        ///< false: the family's own solids walk

  /// Keys `walk_...` and `walker`.
  void read(config::MapReader& in);
  void write(nlohmann::ordered_json& out) const;

  /// One walker with its path (a PathMotion, knots from t = 0 to `horizon` or a little beyond), clear of start and
  /// witness at every time: each leg is shown to be by SceneBuilder::clear_for() as it is drawn. False where no first
  /// leg is found; later ones can always be walked back. `item` numbers the draws.
  bool sample(SceneBuilder& builder, const Way& way, const ObjectMix& mix, double horizon, std::uint64_t item,
              WorldObject& object) const;
};

}  // namespace moma
