#pragma once

#include <variant>
#include <vector>

#include "controller/types.h"

namespace moma {

/// Motions of a pose over time, starting at its pose X_0 at t = 0. World axes.
struct StaticMotion {};
struct LinearMotion {
  Vector6 V_W = Vector6::Zero();  ///< [angular; linear] of the pose's own origin, constant
};
struct PathMotion {  ///< constant at its ends; linear and slerp between knots
  std::vector<double> times;
  std::vector<Vector3> positions;
  std::vector<Eigen::Quaterniond> quaternions;
};
struct CircleMotion {  ///< X_0 turns rigidly about the axis through the centre
  Vector3 center = Vector3::Zero();
  Vector3 axis = Vector3::UnitZ();
  double rate = 0.0;  ///< [rad/s]
};
struct SplineMotion {  ///< natural cubic through the positions, with the orientation of X_0; constant at its ends
  std::vector<double> times;
  std::vector<Vector3> positions;
};
using Motion = std::variant<StaticMotion, LinearMotion, PathMotion, CircleMotion, SplineMotion>;

struct MovingPose {
  Isometry X = Isometry::Identity();
  Vector6 V_W = Vector6::Zero();  ///< twist at the pose's origin
};

/// Returns pose and twist at time t >= 0. The twist is the derivative of the pose (checked by differences).
MovingPose evaluate(const Motion& motion, const Isometry& X_0, double t);

/// True if the pose is at rest from time t on.
bool at_rest(const Motion& motion, double t);

/// A path back and forth between two points, `leg` seconds each way, until `duration` has passed.
PathMotion to_and_fro(const Vector3& from, const Vector3& to, double leg, double duration);

}  // namespace moma
