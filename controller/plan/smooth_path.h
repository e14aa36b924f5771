#pragma once

#include <span>
#include <vector>

#include "controller/plan/counted_draws.h"
#include "controller/plan/free_space.h"
#include "controller/plan/path.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Leads a mobile robot past the corners of a path, where edges (edge.h) stop at each. A simulated robot pursues one
/// corner after the other, and turns to the next one `lead` seconds before it is there:
///
///   t = max(d / linear, |e_i| / speed_i),   qdot = e / t,
///   v = cos(off) min(linear, d / t),        omega = sign(off) min(angular, stoppable_speed(|off|)),
///
/// with the joints' errors e, the distance d and the angle `off` between a differential base's driving direction
/// (backwards where the corner is behind it) and the corner. An omnidirectional base goes straight and turns evenly, as
/// joints do. Accelerations ramp all velocities. At the end a differential base keeps its heading if the arm reaches
/// the goal from there, and turns to the path's otherwise. Overlapping triangles of the motion make a path, and
/// FreeSpace checks it. Where it is not free, the lead of the nearest corner shrinks, at last to a stop in the corner's
/// own configuration; the motion between two such stops is the edge. Then the search leaves out corners and raises
/// leads as long as that is quicker and free.
class SmoothPath {
 public:
  /// Largest number of corners, start and end included.
  static constexpr std::size_t kMostCorners = 97;

  /// References must outlive it.
  SmoothPath(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik);

  /// Begins with a path's corners, from where the braking ends to a configuration with E at its goal, for a path that
  /// takes less than `within` seconds. The space keeps its distances until the work is done.
  void begin(std::span<const WholeConfiguration> corners, const Braking& braking, double within) noexcept;
  /// Does one piece of work: simulates a motion, or checks some of its moments. True if work is left.
  bool work() noexcept;
  /// Ends with the best path so far.
  void finish() noexcept;

  bool found() const noexcept { return stage_ == Stage::kFound; }
  /// Motions, duration and pass of the path, once found.
  const Path& path() const noexcept { return best_.path; }

 private:
  enum class Stage { kTry, kCheck, kFound, kFailed };
  /// How the robot leaves the start, passes a corner or comes to the end, from the quickest way on.
  enum Passing { kEarly, kLate, kStop };
  struct Corner {
    WholeConfiguration c;
    int passing = kEarly;  // at the end of a path: kEarly keeps the heading, kLate turns to that of `c`
  };
  struct ToGo {
    Vector2 way = Vector2::Zero();  // of the base [m]
    double distance = 0.0;          // its length [m]
    double ahead = 0.0;             // cosine of the angle from a driving direction to the corner
    double off = 0.0;               // from the driving direction to the corner, at it to its heading [rad]
    double base = 0.0, arm = 0.0;   // times at full speed [s]
    double farthest = 0.0;          // joint [rad, m]
  };
  struct Moment {
    WholeConfiguration c;
    int target;  // the corner that it pursued
  };
  // The simulated robot, with the velocities (v, 0, omega) of a differential base, else in W.
  struct Driving {
    WholeConfiguration at, u;
    bool turned = true;  // towards the corner, since it stopped
    int steps = 0;       // of the motion so far
  };
  struct Motion {
    std::vector<Corner> corners;
    std::vector<Driving> legs;    // before it pursues each corner
    std::vector<Moment> moments;  // the start, and after each step
    Path path;
  };

  bool aim(std::size_t leg) noexcept;
  void resume(std::size_t leg) noexcept;
  bool simulate(std::size_t leg) noexcept;
  int steps() const noexcept { return static_cast<int>(now_.moments.size()) - 1; }
  bool log() noexcept;
  template <class Place>
  bool play(double time, const Place& place) noexcept;
  bool brake() noexcept;
  bool follow_edge(const WholeConfiguration& end) noexcept;
  ToGo to_go(const WholeConfiguration& c) noexcept;
  bool arrived(const ToGo& rest, bool turns) const noexcept;
  void pursue(const ToGo& rest, const WholeConfiguration& c, bool stops, bool turns) noexcept;
  void lay() noexcept;
  void tighten(double t) noexcept;
  std::size_t vary() noexcept;
  void move(std::size_t corner) noexcept;

  const MotionLimits& limits_;
  const PlanParams& params_;
  FreeSpace& space_;
  const WholeBodyIk& ik_;

  Stage stage_ = Stage::kFailed;
  Isometry X_WE_ = Isometry::Identity();  // of the end
  Braking braking_;
  MotionState start_;
  double limit_ = 0.0, within_ = 0.0;  // of the path, and of the next try [s]
  int tries_ = 0;
  CountedDraws draws_;
  Motion now_, best_;  // the best one has no corners until one is free
  double from_ = 0.0;  // time at which now_ begins to differ from the best motion [s]
  // Time up to which now_ is known to be free [s]: from from_ to its end, then from its start, added to its duration.
  double checked_ = 0.0;

  Driving robot_;
  VectorX arm_end_;
  double direction_ = 1.0;   // 1: it drives forwards, -1: backwards; 0: not known for this corner
  bool base_there_ = false;  // at the corner
  int target_ = 0;           // the corner
  Edge edge_;
};

}  // namespace moma
