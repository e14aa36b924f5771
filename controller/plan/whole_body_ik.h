#pragma once

#include <memory>
#include <span>

#include "controller/plan/counted_draws.h"
#include "controller/plan/free_space.h"

namespace moma {

/// A configuration with E at the goal, and its cost: the time of an edge from the start, plus penalties for little
/// clearance, little room to joint limits and little manipulability [s].
struct GoalConfiguration {
  WholeConfiguration c;
  double time = 0.0;    ///< time of that edge [s]
  double cost = 0.0;    ///< [s]
  int tier = 0;         ///< first tier of the plan in which it is free
  bool rooted = false;  ///< true for a root of the search's tree
};

/// Progress of a search after a piece of its work: more is left, it has found something, or there is nothing (more).
enum class Progress { kMore, kFound, kNone };

/// Inverse kinematics of base and arm together. One per controller; only the constructor allocates.
class WholeBodyIk {
 public:
  WholeBodyIk(std::shared_ptr<const RobotModel> model, const WholeBodyIkParams& params, const MotionLimits& limits);

  /// Sets the kept share of the joints' margins.
  void keep_room(double room) noexcept;

  /// Moves base and arm together from `c` until E is at the goal: damped least squares, c += W J^T (J W J^T + 1e-4
  /// I)^-1 e, with the error's two parts clamped (0.6 rad, 0.3 m) and half weights on the base's place (Wampler, IEEE
  /// Trans. SMC 16(1), 1986). A joint that a step would move beyond a bound stays at it, and the others compensate; a
  /// joint whose range is a full turn continues from its other limit. The base may move sideways, since the result is a
  /// place and not a motion. Joints keep a little more room than a path. It ends after 20 iterations, or once four of
  /// them do not halve the error; two cost one check. True if E comes within 1 mm and 2 mrad. Without `moves_base` the
  /// base stays.
  bool solve(FreeSpace& space, const Isometry& X_WG, WholeConfiguration& c, bool moves_base = true) const noexcept;

  /// Runs try number `index`. It begins with a base around the goal (every fourth try: on the start's side), headed to
  /// the goal or freely, and with the arm of the start, at `ready`, or drawn freely. Every third try of a fixed robot,
  /// or for a `hard` goal, begins near an earlier solution, and for a hard one every third leaves the base at the start
  /// if that is near enough. True if solve() succeeds from there; joints that wind are unwound.
  bool find(FreeSpace& space, const Isometry& X_WG, const WholeConfiguration& start,
            std::span<const GoalConfiguration> found, int index, CountedDraws& draws, bool hard,
            WholeConfiguration& c) const noexcept;

  /// Returns what it costs to be at `c`, a free one, whatever the way there [s]. `roomy` [m] is the clearance that is
  /// worth something. Each part grows to its whole as clearance, room to a joint limit or manipulability vanish.
  double penalty(FreeSpace& space, double roomy, const WholeConfiguration& c) const noexcept;

 private:
  void seed(const FreeSpace& space, const Isometry& X_WG, const WholeConfiguration& start, int index,
            CountedDraws& draws, WholeConfiguration& c) const noexcept;

  double turned_back(int joint, double q) const noexcept;

  std::shared_ptr<const RobotModel> model_;
  WholeBodyIkParams params_;
  const MotionLimits* limits_;
  VectorX lower_, upper_;
  Eigen::VectorXi round_;  // 1 for a joint that goes on from its other limit
};

}  // namespace moma
