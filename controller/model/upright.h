#pragma once

#include <numbers>

#include "controller/describe/describe.h"
#include "controller/model/kinematics.h"
#include "controller/types.h"

namespace moma {

/// A path constraint: an axis of the tool stays within an angle of the vertical, as that of a full cup.
struct Upright {
  Vector3 axis = Vector3::UnitZ();  ///< in E, of any length but 0
  double angle = 0.0;               ///< largest tilt [rad]

  bool operator==(const Upright&) const = default;
};

constexpr void describe(auto& v, Of<Upright>) {
  using T = Upright;
  v.member("axis", &T::axis,
           {.required = true, .text = "axis of E, of any length but 0, that stays near the vertical"});
  v.member("angle", &T::angle,
           {.unit = "rad",
            .range = {0.0, std::numbers::pi, true, false},
            .required = true,
            .text = "largest angle between that axis and the vertical"});
}

/// Returns the angle between the axis and the vertical [rad], for E with the rotation R_WE. Accurate at every angle.
double tilt(const Upright& upright, const Matrix3& R_WE) noexcept;
/// The same for E in the configuration of `kinematics`.
double tilt(const Upright& upright, const Kinematics& kinematics) noexcept;

/// Returns the direction m of the angular velocity that increases the tilt: with u = R_WE a and du/dt = omega x u,
/// d tilt/dt = m omega for m = (z x u)/|z x u| in W. Zero where the axis is vertical, in which case the tilt grows
/// whichever way E turns. m is horizontal, so that the motion of a base changes no tilt.
Vector3 tilt_direction(const Upright& upright, const Matrix3& R_WE) noexcept;

/// Moves the joint values q within [lower, upper] until the tilt is at most `aim` [rad], by Newton steps along its
/// gradient. Takes the base of `kinematics`, which has the result. Returns the number of updates of the kinematics, or
/// -1 if the tilt stays larger. Real-time safe.
int bring_upright(const Upright& upright, double aim, const Eigen::Ref<const VectorX>& lower,
                  const Eigen::Ref<const VectorX>& upper, Kinematics& kinematics, Eigen::Ref<VectorX> q) noexcept;

}  // namespace moma
