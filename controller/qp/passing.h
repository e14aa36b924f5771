#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/shape.h"
#include "controller/params.h"
#include "controller/qp/problem.h"

namespace moma {

/// The tangent from a point to a solid, seen from above.
struct Tangent {
  bool exists = false;                ///< false if the point is inside
  Vector3 n_W = Vector3::Zero();      ///< horizontal unit normal, away from the solid
  Vector3 along_W = Vector3::Zero();  ///< horizontal unit vector to the contact point
  double length = 0.0;                ///< distance to the contact point [m]
};

/// Passing rows: let moving objects pass on one side, for the shapes rigid with a mobile base.
///
/// A damper row bounds the present rate of a distance. A differential base cannot change the distance to an object that
/// approaches from the side, so that the row can only be violated. The base has to leave the object's path in time,
/// forwards or backwards. The velocity obstacle expresses that (Fiorini & Shiller, IJRR 17(7), 1998): at a constant w =
/// v_robot - v_object two solids collide if w points into the cone of tangents to M = {o - r}, the Minkowski difference
/// of object and robot. Two half-planes bound the outside of the cone; a row takes one of them, as ORCA does (van den
/// Berg, Guy, Lin & Manocha, ISRR 2009):
///
///   n^T (J qdot - v_object) >= -max(g, 0)/horizon
///
/// n is the normal of the tangent on the side of the object's path where the robot's shape is, turned outwards by
/// asin(clearance/length). g is the gap along the line of centres [m]: a distant object may still be on a collision
/// course. J is the Jacobian of the shape's centre. All quantities are horizontal. Solids that pass above each other
/// have no row, and rotation of the object is left to damper rows. Without memory: the side depends on the position and
/// changes only in the middle of the path. A row enters where no motion of the base violates it, so that the command
/// does not jump. One per worker; only allocate() allocates.
class PassingRows {
 public:
  PassingRows(const RobotModel& model, const CollisionParams& params);

  /// Sizes the buffers for so many objects. Returns the largest number of rows that add() can append: max_pairs, on top
  /// of those of CollisionRows.
  int allocate(int num_objects);

  /// Selects the objects that need rows: visible, faster than 0.01 m/s horizontally, at a height of possible contact,
  /// and near enough for a row to act. Nearest first (ties: by index). Without such objects the problem is the one
  /// without passing rows.
  void select(const Kinematics& kinematics, const Proximity& proximity, std::span<const ObjectState> states) noexcept;
  /// Appends the rows of the first max_pairs selected objects. Costs no distance query.
  void add(const Kinematics& kinematics, const Proximity& proximity, std::span<const ObjectState> states,
           QpProblem& problem) noexcept;

  /// True if a selected object is within 1 m.
  bool near() const noexcept;

 private:
  struct ApproachingPair {
    double gap;
    int shape, object;
  };
  void append(const Kinematics& kinematics, const ApproachingPair& pair, const Shape& object, const ObjectState& state,
              QpProblem& problem) noexcept;

  const RobotModel* model_;
  PassingParams params_;
  std::size_t max_rows_;
  std::vector<int> shapes_;  // rigid with the base; none for a fixed base
  std::vector<ApproachingPair> chosen_;
  Matrix3X J_;
  VectorX row_;
};

/// Returns the tangent from the origin to M = {o - r} on the side with n^T v <= 0 for the object's velocity v, which
/// demands less of a robot at rest. Exact for every kind of shape.
Tangent passing_tangent(const Shape& robot, const Isometry& X_WR, const Shape& object, const Isometry& X_WO,
                        const Vector3& v_W) noexcept;

}  // namespace moma
