#pragma once

#include <memory>
#include <span>

#include "controller/plan/counted_draws.h"
#include "controller/plan/free_space.h"

namespace moma {

/// A configuration with E at the goal, and what it costs to be there: the time of an edge from the start, and
/// penalties for little clearance, little room to the joints' limits and little manipulability [s].
struct GoalConfiguration {
  WholeConfiguration c;
  double time = 0.0;  ///< of that edge [s]
  double cost = 0.0;
  int tier = 0;         ///< the first of a plan's tiers in which it is free
  bool rooted = false;  ///< a root of the search's tree
};

/// Where to stand and how to hold the arm, so that E is at a goal. Built once per controller; takes no memory after.
class WholeBodyIk {
 public:
  WholeBodyIk(std::shared_ptr<const RobotModel> model, const WholeBodyIkParams& params, const MotionLimits& limits);

  /// The part of the joints' margins that is kept from here on.
  void keep_room(double room) noexcept;

  /// Moves base and arm together from `c` until E is at the goal: damped least squares, c += W J^T (J W J^T + 1e-4
  /// I)^-1 e, with the error's two parts clamped (0.6 rad, 0.3 m) and half weights on the base's place (Wampler, IEEE
  /// Trans. SMC 16(1), 1986). Joints that a step would take beyond a bound stay at it, and the others do what they
  /// would have done; a joint whose range is a full turn continues from its other limit. The base counts as free to go
  /// sideways: it is a place to stand at, not a motion. Joints are kept a little further from their limits than a path
  /// has to be. Ends after 20 iterations, or where four of them did not halve the error; two are charged as one check.
  /// True where E came within 1 mm and 2 mrad. Without `moves_base` the base stays where it is in `c`.
  bool solve(FreeSpace& space, const Isometry& X_WG, WholeConfiguration& c, bool moves_base = true) const noexcept;

  /// One try of the `index`-th kind: a base around the goal (each fourth as far from it as the start, 0.7 m at most),
  /// turned to it or anyhow; the arm as it is at the start, at `ready`, or anyhow. Or, every third of a robot that is
  /// bolted down, near one that was found before. True where solve() succeeds from there; joints that wind are unwound.
  bool find(FreeSpace& space, const Isometry& X_WG, const WholeConfiguration& start,
            std::span<const GoalConfiguration> found, int index, CountedDraws& draws,
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
  bool mobile_;
  VectorX lower_, upper_;
  Eigen::VectorXi round_;  // 1 for a joint that goes on from its other limit
};

}  // namespace moma
