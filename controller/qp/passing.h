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
  bool exists = false;                ///< false where the point is inside
  Vector3 n_W = Vector3::Zero();      ///< horizontal unit normal, away from the solid
  Vector3 along_W = Vector3::Zero();  ///< horizontal unit vector to where it touches
  double length = 0.0;                ///< as far as there [m]
};

/// Rows that let objects in motion pass on one side, for the shapes rigid with a base that drives.
///
/// The usual row bounds how fast a distance shrinks now. Where an object comes at a differential base from the side, no
/// motion of the base changes that: the row can only be broken. What the base can do is to be out of the way in time,
/// forward or backward, long before. That is the velocity obstacle (Fiorini & Shiller, IJRR 17(7), 1998): with
/// w = v_robot - v_object, two solids collide, if w stays as it is, where w points into the cone of tangents to
/// M = {o - r}, the object less the robot. What is outside is bounded by two half-planes, of which one is taken, as in
/// ORCA (van den Berg, Guy, Lin & Manocha, ISRR 2009):
///
///   n^T (J qdot - v_object) >= -max(g, 0)/horizon
///
/// n is the normal of the tangent on the side of the object's path where the robot's shape is, turned outwards by
/// asin(clearance/length), so that there is room. g is the gap along the line of centres [m]: what is far may still
/// be on a wrong course. J is that of the shape's centre. All of it is horizontal, and solids that pass above each
/// other have no row; turning of the object is left to the usual rows, which stay as they are. Nothing is remembered:
/// the side is a matter of place, and changes only in the middle of the path. A row enters where nothing the base can
/// do would break it, so that the command does not jump. One per worker; only allocate() takes memory.
class PassingRows {
 public:
  PassingRows(const RobotModel& model, const CollisionParams& params);

  /// Sizes the buffers for so many objects. Returns the most rows that add() can append: max_pairs, on top of those
  /// of CollisionRows.
  int allocate(int num_objects);

  /// Looks for the objects that need rows: visible, faster than 0.01 m/s horizontally, at a height where they could
  /// touch, and so near that a row could hold. Nearest first (ties: by index). Without such objects there is nothing
  /// to add, and the problem is what it is without passing rows.
  void select(const Kinematics& kinematics, const Proximity& proximity, std::span<const ObjectState> states) noexcept;
  /// Appends the rows of the first max_pairs selected. Costs no distance query.
  void add(const Kinematics& kinematics, const Proximity& proximity, std::span<const ObjectState> states,
           QpProblem& problem) noexcept;

  /// Whether one of the selected is within 1 m.
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
  std::vector<int> shapes_;  // rigid with the base; none where it does not drive
  std::vector<ApproachingPair> chosen_;
  Matrix3X J_;
  VectorX row_;
};

/// The tangent from the origin to M = {o - r} on the side where n^T v <= 0 for the object's velocity v: the one that
/// asks less of a robot that stands still. Exact for every kind of shape.
Tangent passing_tangent(const Shape& robot, const Isometry& X_WR, const Shape& object, const Isometry& X_WO,
                        const Vector3& v_W) noexcept;

}  // namespace moma
