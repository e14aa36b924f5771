#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/plan/free_space.h"
#include "controller/plan/path.h"
#include "controller/plan/steered_drive.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Looks for the quickest way without a corner from where a robot stands to its goal: base and arm go straight, a
/// differential base steers to where it will stand (steered_drive.h). Whole-body inverse kinematics from about the
/// start give ends; speeds and accelerations give the time of the way to each; the quickest way that is free counts.
/// Further tries, which begin between the start and the best end, then pull the end towards the start.
///
/// There is none to a goal where the hand is nearer to an object than a path's clearance: the planner is for those
/// (planner.h). Work is cut into pieces of one inverse kinematics or one way's checks: the same way comes out however
/// it is spread. Construction and set_objects() may take memory, nothing else does.
class DirectWay {
 public:
  DirectWay(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void set_objects(std::span<const ObjectShape> objects);
  /// Begins at `start`, where the robot stands.
  void begin(const WholeConfiguration& start, const Isometry& X_WG, std::span<const ObjectState> objects) noexcept;
  /// Works until `budget` checks are used up or all is known; takes what it used from `budget`. True as long as there
  /// is more to do.
  bool advance(long& budget) noexcept;

  /// Whether a free way is known, and the quickest so far.
  bool found() const noexcept { return best_.time < kInfinity; }
  const Path& path() const noexcept { return best_path_; }
  const MotionLimits& limits() const noexcept { return limits_; }

 private:
  struct End {
    WholeConfiguration c;             // where a way ends
    Vector2 point = Vector2::Zero();  // to which a differential base steers [m]
    bool stays = false;               // the base does not move
    double time = kInfinity;          // of the way [s]
  };
  enum class Stage { kTries, kChecks, kNearer, kDone };

  void work() noexcept;
  void seed(End& end) noexcept;
  bool make(End& end) noexcept;
  bool drive_to(const Vector2& point) noexcept;
  bool take(const End& end) noexcept;
  bool steers(const End& end) const noexcept { return limits_.base->nonholonomic() && !end.stays; }
  void lay(const End& end) noexcept;
  bool free() noexcept;

  MotionLimits limits_;
  PlanParams params_;
  FreeSpace space_;
  WholeBodyIk ik_;
  GoalClearance goal_clearance_;
  SteeredDrive drive_;

  Stage stage_ = Stage::kDone;
  WholeConfiguration start_;
  Isometry X_WG_ = Isometry::Identity();
  CountedDraws draws_;
  int tries_ = 0;
  std::vector<End> ends_;  // the quickest first
  std::size_t next_ = 0;   // the next one of them to be checked
  End best_;
  Edge edge_;
  WholeConfiguration point_;
  Path path_, best_path_;
  double longest_ = 0.0;  // about how far the robot's farthest point goes on path_ [m]
};

}  // namespace moma
