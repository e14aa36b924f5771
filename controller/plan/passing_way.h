#pragma once

#include <vector>

#include "controller/plan/blend.h"
#include "controller/plan/free_space.h"
#include "controller/plan/path.h"
#include "controller/plan/steered_drive.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Ways to a goal that need not be stopped at: they end there in motion. The base does not slow down for the goal: the
/// arm moves against it as far as the hand would be too quick, J_arm qdot = -part J_base v. A try draws a place of the
/// base near the goal and joints. A differential base steers past that place (steered_drive.h), or towards the next
/// goal; an omnidirectional one has a velocity there; a fixed one stays. Inverse kinematics reach the goal from where
/// the base then is. Tries are ranked by their time and an estimate of the base's time on to the next goal.
///
/// A part of DirectWay, which owns the other parts. One piece of work is one try. Only construction allocates.
class PassingWay {
 public:
  PassingWay(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik);

  /// `space` has its objects and clearances. `pass`: a configuration at the goal; tries begin around it.
  void begin(const MotionState& start, const Isometry& X_WG, const Isometry& X_WN,
             const WholeConfiguration& pass) noexcept;
  /// Makes one try.
  void work() noexcept;

  std::size_t count() const noexcept { return found_.size(); }
  /// Adds try number `index`, the best first, to `path`, whose origin is its start. Returns the state in which it
  /// passes the goal. `longest`: approximate travel of the robot's farthest point [m].
  const MotionState& lay(std::size_t index, Path& path, double& longest) noexcept;

 private:
  struct Try {
    MotionState pass;
    // A differential base drives to `via` at this speed at most, until it is that near or has driven so long.
    Vector2 via = Vector2::Zero();
    SteeredDrive::Passing drive{0.0, 0.0, kInfinity};
    Glide arm, base;
    double cost = kInfinity;  // [s]
  };

  void seed(Try& a) noexcept;
  bool make(Try& a) noexcept;
  bool make_steered(Try& a) noexcept;
  bool make_free(Try& a) noexcept;
  bool hold_hand(MotionState& pass) noexcept;
  bool drive(const Try& a) noexcept;
  double time_on(const MotionState& pass) noexcept;

  const MotionLimits& limits_;
  const PlanParams& params_;
  FreeSpace& space_;
  const WholeBodyIk& ik_;
  SteeredDrive drive_;

  MotionState start_;
  Isometry X_WG_ = Isometry::Identity(), X_WN_ = Isometry::Identity();
  WholeConfiguration near_;
  CountedDraws draws_;
  int tries_ = 0;
  std::vector<Try> found_;  // the best first
  Path path_;
};

}  // namespace moma
