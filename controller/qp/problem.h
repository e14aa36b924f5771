#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/model/proximity.h"
#include "controller/model/robot_model.h"
#include "controller/types.h"

namespace moma {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

enum class RowKind { kTracking, kObject, kFloor, kSelf, kSeparation, kWheel, kDrive, kUpright };

/// True if the row bounds the rate of a distance.
constexpr bool is_collision(RowKind kind) noexcept {
  return kind == RowKind::kObject || kind == RowKind::kFloor || kind == RowKind::kSelf;
}

/// A row about a distance whose largest coefficient is below this depends on no motion of the robot [m/s per unit
/// velocity].
inline constexpr double kNoEffect = 1e-9;

/// A value this near to its limit is held by it [m/s, rad/s].
inline constexpr double kHeld = 1e-8;

/// Subject of a constraint row, with its input quantities. tracking: (component 0-5, -); object: (robot shape, object);
/// floor: (robot shape, -); self: (robot shape, robot shape); separation: (robot shape, object); wheel: (wheel, -);
/// drive: (0 or 1: the diagonal x + y or x - y, -); upright: (0, -).
struct RowId {
  RowKind kind = RowKind::kTracking;
  int first = 0;
  int second = 0;
  bool moves = false;  ///< the object moves
  /// Distance of the two shapes and their nearest points [m]; zero for rows that are not about a distance.
  double d = 0.0;
  Vector3 p_first_W = Vector3::Zero();
  Vector3 p_second_W = Vector3::Zero();
};

/// min 1/2 x^T diag(H) x + g^T x  subject to  lbA <= A x <= ubA, lb <= x <= ub (the form of qpOASES). x = (qdot,
/// delta), delta in R^6, absent if tracking is a hard equality. Only allocate() allocates; rows are appended until
/// `capacity()`. H is diagonal by construction: every term of the objective is.
struct QpProblem {
  VectorX H;    ///< n, the diagonal
  VectorX g;    ///< n
  VectorX lb;   ///< n
  VectorX ub;   ///< n
  RowMatrix A;  ///< capacity() x n; the first `rows` count
  VectorX lbA;  ///< capacity()
  VectorX ubA;  ///< capacity()
  std::vector<RowId> ids;
  int rows = 0;

  int n() const noexcept { return static_cast<int>(H.size()); }
  int capacity() const noexcept { return static_cast<int>(A.rows()); }

  void allocate(int num_variables, int max_rows);
  /// Removes rows and objective, and keeps the bounds.
  void clear() noexcept;
  /// Appends a zero row and returns its index, or -1 if the problem is full.
  int append(const RowId& id, double lower, double upper) noexcept;
  /// Appends a row with these coefficients of the leading variables. False if the problem is full.
  bool append(const RowId& id, double lower, double upper, const Eigen::Ref<const VectorX>& row) noexcept;

  /// True if x is at a limit of the row, to within kHeld.
  bool holds(int row, const Eigen::Ref<const VectorX>& x) const noexcept {
    const double value = A.row(row).dot(x);
    return ubA[row] - value <= kHeld || value - lbA[row] <= kHeld;
  }

  /// Returns 1/2 x^T H x + g^T x; `x` may be longer than n (the relaxed problem's slack is ignored).
  double cost(const Eigen::Ref<const VectorX>& x) const noexcept;
};

/// "tracking/3", "object/NAME/SHAPE", "floor/SHAPE", "self/A/B",
/// "separation/NAME/SHAPE", "wheel/left", "drive/+", "upright".
std::string row_name(const RowId& id, const RobotModel& model, std::span<const std::string> object_names);

/// Returns the largest of: violation of bounds and rows; |H x + g + A^T lambda + mu|; a multiplier's wrong sign;
/// |multiplier| times distance to its bound. Multipliers are positive at upper, negative at lower limits. Allocates.
double kkt_residual(const QpProblem& problem, const VectorX& x, const VectorX& bound_multipliers,
                    const VectorX& row_multipliers);

}  // namespace moma
