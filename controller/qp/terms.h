#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "controller/qp/limits.h"
#include "controller/qp/problem.h"
#include "controller/safe/goal_clearance.h"
#include "controller/situation.h"

namespace moma {

/// Task of one step that the QP solves. A policy (policy/policy.h) or a guard (guard/guard.h) fills it.
struct QpTask {
  /// Velocities that the objective pulls the robot to, in place of the terms about base, joints and manipulability.
  struct Pull {
    const VectorX* velocities = nullptr;  ///< one per velocity; null: zero
    double base_weight = 0.0;
    double joint_weight = 0.0;
  };

  Task task;                               ///< twist of E, scale of its slack, whether a detour bends it
  std::optional<Pull> pull = {};           ///< empty: base, joints and manipulability have their own terms
  const VelocityBounds* bounds = nullptr;  ///< null: the builder's own
  std::optional<Vector3> base = {};        ///< velocity to which the base is held, clipped into its bounds
  KeptDistance keeps = {};  ///< distance to objects at rest that rows allow a path; infinite: the rows' own [m]
  bool passes = false;      ///< rows may let the robot approach what rests as fast as `pull`'s velocities
  bool evades = false;      ///< `base` starts an evasion: rows about the base's motion are left out
};

/// Value of one term of the objective at a solution: its part of 1/2 x^T H x + g^T x.
struct TermCost {
  std::string_view words;
  double value = 0.0;
};

/// Objective of the QP: a sum of terms, listed with their words in terms.cc. Each term writes its own part of the
/// diagonal of H and of g. The parts are kept, so that an explanation reads the numbers of the step. Velocities come
/// first in x: base, then joints, then delta. Only allocate() and costs() allocate.
class Objective {
 public:
  static constexpr int kTerms = 10;

  void allocate(int num_variables);
  /// Removes all terms: costs() is empty.
  void clear() noexcept { on_ = {}; }
  /// Poses H and g of a problem that has its rows.
  void pose(const ControllerParams& params, const RobotModel& model, const Situation& now, const QpTask& asked,
            QpProblem& problem) noexcept;
  /// Returns the costs at x of the active terms of the last pose(), in the order of controller.md. Their sum is
  /// QpProblem::cost(x).
  std::vector<TermCost> costs(const VectorX& x) const;

 private:
  MatrixX H_, g_;  // one column per term
  std::array<bool, kTerms> on_ = {};
};

}  // namespace moma
