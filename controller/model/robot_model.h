#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/describe/enumeration.h"
#include "controller/model/sensor.h"
#include "controller/model/shape.h"
#include "controller/types.h"

namespace moma {

enum class BaseType { kFixed, kDifferential, kOmnidirectional };
constexpr auto words(Of<BaseType>) {
  return std::to_array<std::string_view>({"fixed", "differential", "omnidirectional"});
}

enum class JointType { kFixed, kRevolute, kContinuous, kPrismatic };
constexpr auto words(Of<JointType>) {
  return std::to_array<std::string_view>({"fixed", "revolute", "continuous", "prismatic"});
}

/// Largest number of controlled joints of a robot, for which the control step's buffers are sized.
inline constexpr int kMaxJoints = 64;

struct Inertial {
  double mass = 0.0;                ///< [kg]
  Vector3 com_L = Vector3::Zero();  ///< centre of mass in the link frame [m]
  Matrix3 I_C = Matrix3::Zero();    ///< inertia about the centre of mass, link axes [kg m^2]
};

/// One rigid link and the joint to its parent. Links are in topological order (parents first): links[0] is "@base", the
/// mobile base frame B; links[1] is the URDF's root, rigid at the mount pose.
struct Link {
  std::string name;
  int parent = -1;    ///< index of the parent link; -1 for "@base" only
  std::string joint;  ///< URDF joint name; empty for "@base" and the root
  JointType joint_type = JointType::kFixed;
  Isometry X_PJ = Isometry::Identity();  ///< parent link frame to joint frame at zero displacement
  Vector3 axis = Vector3::UnitZ();       ///< unit joint axis in the joint (= link) frame
  int controlled = -1;                   ///< index into RobotModel::joints, or -1: held at `held`
  double held = 0.0;                     ///< [rad] or [m], for movable joints that are not controlled
  std::optional<Inertial> inertial;      ///< absent if the URDF has none
};

/// A controlled joint: on the chain from the root to the tip, not locked; in chain order. At most kMaxJoints.
struct ControlledJoint {
  std::string name;
  JointType type = JointType::kRevolute;
  int link = -1;                                            ///< the link that it moves
  double lower = -std::numeric_limits<double>::infinity();  ///< [rad] or [m]; infinite for continuous
  double upper = std::numeric_limits<double>::infinity();
  double velocity = 0.0;  ///< largest speed, > 0 [rad/s] or [m/s]
  double effort = 0.0;    ///< [Nm] or [N]; 0 if unknown
  /// Greatest acceleration and jerk, by the maker or as the motors hold them; infinite if unknown [rad/s^2, rad/s^3] or
  /// [m/s^2, m/s^3]. Bounds on the time to a goal use them; a controller's limits are its own gains.
  double acceleration = std::numeric_limits<double>::infinity();
  double jerk = std::numeric_limits<double>::infinity();
};

struct Wheels {
  double radius = 0.1;      ///< R [m]
  double separation = 0.5;  ///< W, left to right [m]
  double wheelbase = 0.0;   ///< front to rear [m]; mecanum only
  double max_speed = 20.0;  ///< [rad/s]
  double width = 0.0;       ///< of a wheel, which is a collision shape then [m]; 0 if not given
};

struct MobileBase {
  BaseType type = BaseType::kFixed;
  Isometry X_BM = Isometry::Identity();  ///< mount: the URDF's root in the base frame
  double max_linear = 0.0;               ///< [m/s]
  double max_angular = 0.0;              ///< [rad/s]
  Vector2 max_acceleration{2.0, 4.0};    ///< the plant's ramp [m/s^2, rad/s^2]
  std::optional<Wheels> wheels;
  double mass = 0.0;  ///< of the footprint [kg]; 0 if not given
};

struct CollisionShape {
  std::string name;  ///< unique: the link's name, with /2, /3 ... from its second shape on
  int link = 0;
  Shape shape;
  Isometry X_LS = Isometry::Identity();
  bool rigid_with_base = false;  ///< no controlled joint between it and "@base"
};

/// Carried::support of an object that has been lifted clear, and of one that stands on the floor.
inline constexpr int kNoSupport = -1, kFloorSupport = -2;

/// An object in the hand: it moves with E, and is no obstacle.
struct Carried {
  int object = 0;                        ///< index of the object in the scene
  Isometry X_EO = Isometry::Identity();  ///< its pose in E
  int support = kNoSupport;              ///< index of the object from which it has not been lifted clear yet
  /// Indices of robot shapes that it may touch, beside those that are rigid with E; -1: none.
  Vector6 touch = Vector6::Constant(-1.0);

  bool operator==(const Carried& other) const noexcept {
    return object == other.object && support == other.support && X_EO.matrix() == other.X_EO.matrix() &&
           touch == other.touch;
  }
};

/// A pair of robot shapes (indices, first < second) whose contact is a self-collision.
struct SelfPair {
  int first = 0;
  int second = 0;
  bool row = true;  ///< false: cannot come within the stop distance; no QP row, but checked for contact
};

struct MountedSensor {
  Sensor sensor;
  int link = 0;
  Isometry X_LC = Isometry::Identity();  ///< of a head that looks straight ahead

  /// Returns X_LC of a head that looks there.
  Isometry turned(const Gaze& gaze) const noexcept {
    if (gaze == Gaze{}) return X_LC;
    const Matrix3 R =
        (Eigen::AngleAxisd(gaze.pan, Vector3::UnitZ()) * Eigen::AngleAxisd(gaze.tilt, Vector3::UnitY())).matrix();
    return pose_of(R * X_LC.linear(), sensor.head.axes + R * (X_LC.translation() - sensor.head.axes));
  }
};

/// Immutable once built: share it as std::shared_ptr<const RobotModel> among threads. Configuration: base (x, y, phi)
/// in W and q, one value per controlled joint. Velocity: (v, omega | qdot) differential, (v_x, v_y, omega | qdot) in
/// base axes omnidirectional, qdot fixed.
struct RobotModel {
  std::string name;
  MobileBase base;
  std::vector<Link> links;
  std::vector<ControlledJoint> joints;
  int tip = -1;                          ///< link that carries E
  Isometry X_TE = Isometry::Identity();  ///< tip link to E (tool offset)
  VectorX ready;                         ///< size num_joints()
  std::vector<CollisionShape> shapes;
  std::vector<SelfPair> self_pairs;
  std::vector<MountedSensor> sensors;
  /// True if the last shape is spare: it stands for the carried object (with_spare_shape()).
  bool spare = false;
  std::optional<Carried> carried;

  /// The shapes without a spare one while nothing is carried.
  std::span<const CollisionShape> present_shapes() const noexcept {
    return {shapes.data(), shapes.size() - (spare && !carried ? 1 : 0)};
  }
  const Link& link(int i) const noexcept { return links[static_cast<std::size_t>(i)]; }
  const ControlledJoint& joint(int i) const noexcept { return joints[static_cast<std::size_t>(i)]; }
  const CollisionShape& shape(int i) const noexcept { return shapes[static_cast<std::size_t>(i)]; }
  int num_joints() const noexcept { return static_cast<int>(joints.size()); }
  /// Number of velocity coordinates of the base (model/base_kind.h); 0 for a fixed one.
  int base_dof() const noexcept;
  bool mobile() const noexcept { return base_dof() > 0; }
  int num_velocities() const noexcept { return base_dof() + num_joints(); }
  /// -1 if there is none.
  int find_link(std::string_view link_name) const noexcept;
  /// Returns the link nearest to the root that no controlled joint separates from `link`: one that a controlled joint
  /// moves, or 0.
  int rigid_root(int link) const noexcept;
  /// Returns the indices of the shapes that no controlled joint separates from E.
  std::vector<int> hand_shapes() const;
  /// Largest |velocity| of every velocity coordinate, base first; size num_velocities().
  VectorX velocity_limits() const;
  /// Names of the velocity coordinates: "v", "omega" / "v_x", "v_y", "omega", then joint names.
  std::vector<std::string> velocity_names() const;
  /// True if a shape is the carried object and `second`, an object or kFloorSupport, its support: no collision.
  bool stands_on(int shape, int second) const noexcept {
    return carried && carried->support == second && second != kNoSupport &&
           shape + 1 == static_cast<int>(shapes.size());
  }
  /// True if `pair` is one of a shape and the carried object, which may touch it: no self-collision.
  bool may_touch(const SelfPair& pair) const noexcept {
    return carried && pair.second + 1 == static_cast<int>(shapes.size()) &&
           (carried->touch.array() == static_cast<double>(pair.first)).any();
  }
};

/// Returns a copy of the robot with a spare shape, and its self pairs with every shape that is not rigid with E.
std::shared_ptr<RobotModel> with_spare_shape(const RobotModel& model);
/// Makes the spare shape the carried object, whose geometry is `shape`, or none. Real-time safe. Whoever owns the
/// model calls it between two uses of the parts that share it.
void carry(RobotModel& model, const std::optional<Carried>& carried, const Shape* shape) noexcept;

/// Returns the factor on lengths along a joint's range (of dampers, of margins of paths): 1 for revolute joints. For a
/// prismatic joint with a range below 3 m it is the range over 3, where 3 rad is the smallest range of the arm for
/// which the lengths were chosen.
inline double limit_part(const ControlledJoint& joint) noexcept {
  constexpr double kWhole = 3.0;
  if (joint.type != JointType::kPrismatic) return 1.0;
  return std::min(1.0, (joint.upper - joint.lower) / kWhole);
}

}  // namespace moma
