#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "controller/model/kinematics.h"

namespace moma {

/// Constant properties of an object in a scene.
struct ObjectShape {
  std::string name;
  Shape shape;
};

/// Covariances of a tracked object's position [m^2] and linear velocity [(m/s)^2], both of its origin: 3 x 3,
/// symmetric, positive semidefinite, in world axes.
struct ObjectCovariance {
  Matrix3 position_W = Matrix3::Zero();
  Matrix3 velocity_W = Matrix3::Zero();
};

/// Present state of an object. V_WO_W = [angular; linear] in world axes, linear velocity at the object's origin.
struct ObjectState {
  Isometry X_WO = Isometry::Identity();
  Vector6 V_WO_W = Vector6::Zero();
  bool visible = true;  ///< false: not sensed now; no distances, no rows
  /// Covariances that a tracker states for this measurement. Without them the standard deviations of the controller's
  /// `uncertainty` apply; without `uncertainty` neither does.
  std::optional<ObjectCovariance> covariance = std::nullopt;
  /// Edge lengths of an object whose shape is a box, if they change; zero: those of its shape. With `seen` false the
  /// box is space that no sensor has seen yet. A map sets both (map/seen_map.h); they cross no border.
  Vector3 box = Vector3::Zero();
  bool seen = true;
};

/// Objects at most this fast count as at rest [m/s, rad/s].
inline constexpr double kAtRest = 0.01;

/// True if an object moves.
inline bool in_motion(const ObjectState& object) noexcept { return object.V_WO_W.norm() > kAtRest; }

/// Signed distance between two solids. n_W is a unit vector along which a motion of `first` increases d: from the
/// second's nearest point to the first's, sign kept in penetration (d < 0).
struct Distance {
  double d = 0.0;
  Vector3 n_W = Vector3::UnitZ();
  Vector3 p_first_W = Vector3::Zero();
  Vector3 p_second_W = Vector3::Zero();
};

/// Signed distance between two placed shapes (coal). Allocates: not for the control step.
Distance shape_distance(const Shape& first, const Isometry& X_W1, const Shape& second, const Isometry& X_W2);

/// False for an invalid pose, which sensed data may contain.
bool is_pose(const Isometry& X) noexcept;

enum class PairKind { kObject, kFloor, kSelf };

/// One close pair. `first` is a robot shape; `second` is an object index (kObject), -1 (kFloor) or a robot shape index
/// (kSelf; then `first` < `second` as in SelfPair).
struct ProximityPair {
  PairKind kind = PairKind::kObject;
  int first = 0;
  int second = 0;
  Distance distance;
};

/// Ranges inside which pairs are reported [m]; a negative range switches that kind off. Space that no sensor has seen
/// is an object with a range of its own, at most that of objects.
struct ProximityRanges {
  double object = 0.3;
  double floor = -1.0;
  double self = -1.0;
  double unseen = std::numeric_limits<double>::infinity();
  /// Height by which the carried object counts as raised above the object that it stands on; negative: no such pair.
  double raised = -1.0;

  double of(const ObjectState& state) const noexcept { return state.seen ? object : std::min(object, unseen); }
};

/// Distances between a robot's shapes, a set of objects, the floor (z = 0) and the robot itself, by coal after a broad
/// phase of bounding spheres. The object that the model carries is no obstacle but the robot's last shape; between it
/// and its support there is none but that of ProximityRanges::raised. One per worker. set_objects() may allocate;
/// query() neither allocates nor throws.
class Proximity {
 public:
  explicit Proximity(std::shared_ptr<const RobotModel> model);
  ~Proximity();
  Proximity(Proximity&&) noexcept;
  Proximity& operator=(Proximity&&) noexcept;

  /// Builds the objects' geometry and sizes every buffer for them.
  void set_objects(std::span<const ObjectShape> objects);

  /// Returns all pairs closer than their range, in a fixed order (objects by (shape, object), floor, self); unsorted by
  /// distance. Floor pairs: shapes not rigid with the base. Self pairs: those with `row`. The span is valid until the
  /// next call. There are as many `states` as objects. Invalid poses are left out: an object's own pairs, or
  /// everything for the robot's. No warm start between calls: the same inputs give the same bits.
  std::span<const ProximityPair> query(const Kinematics& kinematics, std::span<const ObjectState> states,
                                       const ProximityRanges& ranges) noexcept;

  /// True if query() would find nothing; stops at the first pair inside its range.
  bool clear(const Kinematics& kinematics, std::span<const ObjectState> states, const ProximityRanges& ranges) noexcept;

  /// Takes over these states for the calls without states. They must stay as they are until the next states come.
  void hold(std::span<const ObjectState> states) noexcept;
  std::span<const ProximityPair> query(const Kinematics& kinematics, const ProximityRanges& ranges) noexcept;
  bool clear(const Kinematics& kinematics, const ProximityRanges& ranges) noexcept;

  /// Does the same for single pairs, with the robot at its last place() or query(). Returns false for an invalid pose;
  /// then no pair has a distance. `second` is as in ProximityPair; objects must be visible and have valid poses.
  bool place(const Kinematics& kinematics) noexcept;
  /// The distance if it is less than `range`, with the bits of query().
  std::optional<Distance> within(PairKind kind, int first, int second, std::span<const ObjectState> states,
                                 double range) noexcept;
  /// Cheap lower bound, up to rounding, of the distance of a pair with an object.
  double least_gap(int shape, int object, const Isometry& X_WO) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moma
