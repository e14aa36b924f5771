#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "controller/describe/enumeration.h"
#include "world/scenario/objects.h"
#include "world/scenario/scene_builder.h"

namespace moma {

enum class Walker { kPerson, kSolid };
constexpr auto words(Of<Walker>) { return std::to_array<std::string_view>({"person", "solid"}); }

/// Pedestrians: each walks at a constant speed of its own from one random waypoint straight to the next, and stops at
/// some of them. Nobody reacts to the robot, unless `yields` says so.
struct Walk {
  using Normal = Distribution::Normal;
  using Uniform = Distribution::Uniform;
  static constexpr Range kPace{0.05, 10.0};
  static constexpr Range kSize{0.01, 10.0};
  static constexpr double kLeastLeg = 0.5;  ///< nearer waypoints are drawn again [m]

  /// [m/s]. Free walking speeds of pedestrians, mean and deviation: Weidmann, Transporttechnik der Fussgaenger,
  /// ETH Zurich, 1993.
  Distribution speed{Normal{1.34, 0.26}};
  Distribution radius{Uniform{0.2, 0.3}};    ///< [m]
  Distribution height{Normal{1.7, 0.1}};     ///< [m]
  double pause = 0.3;                        ///< [1]
  Distribution pause_time{Uniform{0.5, 4}};  ///< [s]
  double margin = 2.0;                       ///< [m]
  Yields yields = {};
  Walker walker = Walker::kPerson;

  /// Walls about the way: a leg keeps off the `solids`, boxes at rest, and every other waypoint is one of the `doors`,
  /// through which people come round corners.
  struct Inside {
    std::span<const WorldObject> solids;
    std::span<const Vector3> doors;
  };

  /// Draws one walker with its path (a PathMotion, knots from t = 0 to `horizon` or slightly beyond), clear of start
  /// and witness at all times: SceneBuilder::clear_for() checks each leg. False if no first leg is found; later legs
  /// can always lead back. `item` numbers the draws.
  bool sample(SceneBuilder& builder, const Way& way, const ObjectMix& mix, double horizon, std::uint64_t item,
              WorldObject& object, const Inside& inside = {}) const;
};

constexpr void describe(auto& v, Of<Walk>) {
  using T = Walk;
  v.member("walk_speed", &T::speed, in_range(T::kPace, "m/s", "speed of each walker; free walking by default"));
  v.member("walk_radius", &T::radius,
           in_range(T::kSize, "m", "radius of the standing capsule that represents a person"));
  v.member("walk_height", &T::height, in_range(T::kSize, "m", "total height of a person"));
  v.member("walk_pause", &T::pause, in_range({0.0, 1.0}, "1", "share of the waypoints at which a walker stops"));
  v.member("walk_pause_time", &T::pause_time, non_negative("s", "duration of a stop"));
  v.member("walk_margin", &T::margin,
           in_range({T::kLeastLeg, 1000.0}, "m", "largest distance of waypoints from the way"));
  v.member("walk_yields", &T::yields,
           unless_default({.text = "people who wait for the robot: {distance, patience, side}"}));
  v.member("walker", &T::walker, {.text = "solid: the family's own solids walk instead of people"});
}

}  // namespace moma
