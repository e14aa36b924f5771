#pragma once

#include <optional>

#include "controller/plan/free_space.h"
#include "controller/plan/glide.h"
#include "controller/plan/path.h"
#include "controller/plan/steered_drive.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Ways that pass a goal in motion. The base keeps its speed at the goal; the arm moves against the base as far as the
/// hand would be too quick, J_arm qdot = -part J_base v. A try draws a place of the base near the goal and joints. A
/// differential base steers past that place (steered_drive.h), or towards the next goal; an omnidirectional one has a
/// velocity there; a fixed one stays. Inverse kinematics reach the goal from where the base then is.
///
/// A part of DirectWay, which owns the other parts. Nothing allocates.
class PassingWay {
 public:
  PassingWay(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik);

  /// `space` has its objects and clearances. `pass`: a configuration at the goal; tries begin around it.
  void begin(const MotionState& start, const Isometry& X_WG, const Isometry& X_WN,
             const WholeConfiguration& pass) noexcept;
  /// Makes try number `index`. Returns its time to the goal; infinite if it fails [s].
  double make(int index, CountedDraws& draws) noexcept;

  /// Lets further tries begin around the last one.
  void keep() noexcept;

  /// State in which the last try passes the goal.
  const MotionState& pass() const noexcept { return pass_; }
  /// Makes the last try a path. `longest`: approximate travel of the robot's farthest point [m].
  void lay(Path& path, double& longest) noexcept;

 private:
  void seed(int index, CountedDraws& draws) noexcept;
  bool make_steered() noexcept;
  bool make_free() noexcept;
  bool hold_hand() noexcept;
  bool drive() noexcept;

  const MotionLimits& limits_;
  const PlanParams& params_;
  FreeSpace& space_;
  const WholeBodyIk& ik_;
  SteeredDrive drive_;

  MotionState start_;
  Isometry X_WG_ = Isometry::Identity(), X_WN_ = Isometry::Identity();
  WholeConfiguration near_;
  std::optional<SteeredDrive::Passing> kept_;

  // The last try.
  MotionState pass_;
  // A differential base drives to `via` at this speed at most, until it is that near or has driven so long.
  Vector2 via_ = Vector2::Zero();
  SteeredDrive::Passing passing_{0.0, 0.0, kInfinity};
  Trapezoid arm_, base_;
  Path path_;
};

}  // namespace moma
