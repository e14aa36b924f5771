#pragma once

// Robots built in code, so that the controller's tests need no files: the Panda's arm (transforms and limits as its
// maker publishes them) on nothing, on a differential base, and a shorter arm with a prismatic lift on a mecanum base.

#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "controller/model/robot_model.h"
#include "controller/step.h"

namespace moma::test {

inline constexpr double kPi = std::numbers::pi;

inline Isometry pose(double x, double y, double z, double roll, double pitch, double yaw) {
  Isometry X = Isometry::Identity();
  X.translation() << x, y, z;
  X.linear() = (Eigen::AngleAxisd(yaw, Vector3::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3::UnitY()) *
                Eigen::AngleAxisd(roll, Vector3::UnitX()))
                   .toRotationMatrix();
  return X;
}

class RobotBuilder {
 public:
  explicit RobotBuilder(std::string name) {
    model_.name = std::move(name);
    model_.links.resize(2);
    model_.links[0].name = "@base";
    model_.links[1].name = "root";
    model_.links[1].parent = 0;
  }
  RobotBuilder& base(BaseType type, const Isometry& mount) {
    model_.base.type = type;
    model_.base.X_BM = mount;
    model_.base.max_linear = 1.0;
    model_.base.max_angular = 1.5;
    model_.base.wheels = Wheels{.radius = 0.1, .separation = 0.5, .wheelbase = 0.4, .max_speed = 12.0};
    model_.links[1].X_PJ = mount;
    return *this;
  }
  RobotBuilder& joint(JointType type, const Isometry& X_PJ, double lower, double upper, double velocity) {
    const int index = static_cast<int>(model_.links.size());
    const std::string n = std::to_string(model_.joints.size() + 1);
    Link link;
    link.name = "link";
    link.name += n;
    link.parent = index - 1;
    link.joint = "joint";
    link.joint += n;
    link.joint_type = type;
    link.X_PJ = X_PJ;
    link.controlled = static_cast<int>(model_.joints.size());
    model_.joints.push_back({.name = link.joint,
                             .type = type,
                             .link = index,
                             .lower = lower,
                             .upper = upper,
                             .velocity = velocity,
                             .effort = 80.0});
    model_.links.push_back(std::move(link));
    return *this;
  }
  RobotBuilder& capsule(int link, double radius, double length, const Isometry& X_LS) {
    const std::string name = model_.links[static_cast<std::size_t>(link)].name;
    int same = 0;
    for (const CollisionShape& s : model_.shapes) same += s.link == link ? 1 : 0;
    model_.shapes.push_back({.name = same == 0 ? name : name + "/" + std::to_string(same + 1),
                             .link = link,
                             .shape = {ShapeKind::kCapsule, Vector3(radius, length, 0.0), nullptr},
                             .X_LS = X_LS,
                             .rigid_with_base = link <= 1});
    return *this;
  }
  RobotBuilder& self_pair(int first, int second) {
    model_.self_pairs.push_back({first, second, true});
    return *this;
  }
  std::shared_ptr<const RobotModel> finish(const Isometry& X_TE, const std::vector<double>& ready) {
    model_.tip = static_cast<int>(model_.links.size()) - 1;
    model_.X_TE = X_TE;
    model_.ready = Eigen::Map<const VectorX>(ready.data(), static_cast<Eigen::Index>(ready.size()));
    return std::make_shared<RobotModel>(model_);
  }

 private:
  RobotModel model_;
};

inline std::shared_ptr<const RobotModel> panda(BaseType type = BaseType::kFixed) {
  RobotBuilder b(type == BaseType::kFixed ? "panda" : "frankie");
  if (type != BaseType::kFixed) b.base(type, pose(0.15, 0.0, 0.38, 0, 0, 0));
  const double h = kPi / 2;
  using enum JointType;
  b.joint(kRevolute, pose(0, 0, 0.333, 0, 0, 0), -2.8973, 2.8973, 2.175)
      .joint(kRevolute, pose(0, 0, 0, -h, 0, 0), -1.7628, 1.7628, 2.175)
      .joint(kRevolute, pose(0, -0.316, 0, h, 0, 0), -2.8973, 2.8973, 2.175)
      .joint(kRevolute, pose(0.0825, 0, 0, h, 0, 0), -3.0718, -0.0698, 2.175)
      .joint(kRevolute, pose(-0.0825, 0.384, 0, -h, 0, 0), -2.8973, 2.8973, 2.61)
      .joint(kRevolute, pose(0, 0, 0, h, 0, 0), -0.0175, 3.7525, 2.61)
      .joint(kRevolute, pose(0.088, 0, 0, h, 0, 0), -2.8973, 2.8973, 2.61);
  if (type != BaseType::kFixed) b.capsule(0, 0.3, 0.1, pose(0, 0, 0.36, 0, 0, 0));
  b.capsule(2, 0.06, 0.28, pose(0, 0, -0.19, 0, 0, 0))
      .capsule(3, 0.06, 0.12, pose(0, 0, 0, 0, 0, 0))
      .capsule(4, 0.06, 0.15, pose(0, 0, -0.14, 0, 0, 0))
      .capsule(5, 0.06, 0.12, pose(0, 0, 0, 0, 0, 0))
      .capsule(6, 0.06, 0.1, pose(0, 0, -0.26, 0, 0, 0))
      .capsule(6, 0.025, 0.14, pose(0, 0.08, -0.13, 0, 0, 0))
      .capsule(7, 0.05, 0.08, pose(0, 0, -0.03, 0, 0, 0))
      .capsule(8, 0.04, 0.14, pose(0, 0, 0.1, h, 0, 0));
  const int n = type != BaseType::kFixed ? 9 : 8;
  for (int last = n - 2; last < n; ++last)
    for (int i = 0; i < 3; ++i) b.self_pair(i, last);
  return b.finish(pose(0, 0, 0.2104, 0, 0, 0), {0.0, -0.3, 0.0, -2.2, 0.0, 2.0, kPi / 4});
}

inline std::shared_ptr<const RobotModel> frankie() { return panda(BaseType::kDifferential); }

inline std::shared_ptr<const RobotModel> mecanum() {
  RobotBuilder b("mecanum");
  b.base(BaseType::kOmnidirectional, pose(0.1, 0.0, 0.2, 0, 0, 0.3));
  using enum JointType;
  const double inf = std::numeric_limits<double>::infinity();
  b.joint(kPrismatic, pose(0, 0, 0.2, 0, 0, 0), 0.0, 0.35, 0.07)
      .joint(kContinuous, pose(0, 0, 0.2, 0, 0, 0), -inf, inf, 1.5)
      .joint(kRevolute, pose(0, 0.05, 0.1, -kPi / 2, 0, 0), -2.0, 2.0, 1.5)
      .joint(kRevolute, pose(0.3, 0, 0, 0.2, 0, 0), -2.5, 2.5, 1.5)
      .joint(kRevolute, pose(0.25, 0, 0, kPi / 2, 0, 0), -3.0, 3.0, 2.0)
      .joint(kRevolute, pose(0.02, 0, 0.1, -kPi / 2, 0, 0), -1.8, 1.8, 2.0)
      .capsule(0, 0.2, 0.3, pose(0, 0, 0.25, 0, kPi / 2, 0))
      .capsule(4, 0.05, 0.25, pose(0.15, 0, 0, 0, kPi / 2, 0))
      .capsule(5, 0.05, 0.2, pose(0.12, 0, 0, 0, kPi / 2, 0))
      .capsule(7, 0.04, 0.1, pose(0, 0, 0.05, 0, 0, 0))
      .self_pair(0, 2)
      .self_pair(0, 3);
  return b.finish(pose(0, 0, 0.12, 0, 0.2, 0), {0.1, 0.2, -0.8, 1.4, 0.3, 0.5});
}

inline std::vector<std::shared_ptr<const RobotModel>> built_robots() { return {panda(), frankie(), mecanum()}; }

using Rng = std::mt19937_64;

inline double uniform(Rng& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

inline Vector3 random_vector(Rng& rng, double size) {
  return {uniform(rng, -size, size), uniform(rng, -size, size), uniform(rng, -size, size)};
}

inline Matrix3 random_rotation(Rng& rng) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(rng), normal(rng), normal(rng), normal(rng));
  return q.normalized().toRotationMatrix();
}

/// Any base, one to nine joints of any kind and axis, capsules on about half of the links.
inline std::shared_ptr<const RobotModel> random_robot(Rng& rng) {
  using enum JointType;
  RobotBuilder b("random");
  const auto somewhere = [&rng](double size) {
    const Vector3 p = random_vector(rng, size);
    return pose(p.x(), p.y(), p.z(), uniform(rng, -kPi, kPi), uniform(rng, -kPi, kPi), uniform(rng, -kPi, kPi));
  };
  constexpr BaseType kBases[] = {BaseType::kFixed, BaseType::kDifferential, BaseType::kOmnidirectional};
  const BaseType base = kBases[rng() % 3];
  if (base != BaseType::kFixed) b.base(base, pose(uniform(rng, -0.3, 0.3), 0, uniform(rng, 0, 0.5), 0, 0, 0));
  std::vector<double> ready;
  int shapes = 0;
  const int joints = 1 + static_cast<int>(rng() % 9);
  for (int i = 0; i < joints; ++i) {
    constexpr JointType kTypes[] = {kRevolute, kRevolute, kPrismatic, kContinuous};
    const JointType type = kTypes[rng() % 4];
    const double middle = type == kPrismatic ? 0.0 : uniform(rng, -1.0, 1.0);
    const double half = type == kPrismatic ? uniform(rng, 0.05, 0.4) : uniform(rng, 0.3, 3.0);
    const double inf = std::numeric_limits<double>::infinity();
    const double room = type == kContinuous ? inf : half;
    // No faster than the laws of joint limits bear at a period of 0.02 s.
    const double speed = std::min(uniform(rng, 0.05, 3.0), 8.0 * half);
    b.joint(type, somewhere(0.35), middle - room, middle + room, speed);
    ready.push_back(middle);
    if (rng() % 2 == 0) {
      b.capsule(i + 2, uniform(rng, 0.02, 0.08), uniform(rng, 0.0, 0.3), somewhere(0.1));
      ++shapes;
    }
  }
  if (shapes > 2) b.self_pair(0, shapes - 1);
  return b.finish(somewhere(0.15), ready);
}

inline VectorX random_joints(const RobotModel& model, Rng& rng, double inside = 0.0) {
  VectorX q(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& j = model.joints[static_cast<std::size_t>(i)];
    const double low = std::isinf(j.lower) ? -kPi : j.lower;
    const double high = std::isinf(j.upper) ? kPi : j.upper;
    q[i] = uniform(rng, low + inside, high - inside);
  }
  return q;
}

inline ObjectShape random_object(Rng& rng, const std::string& name) {
  ObjectShape o{.name = name, .shape = {}};
  switch (rng() % 4) {
    case 0:
      o.shape = {ShapeKind::kSphere, {uniform(rng, 0.05, 0.2), 0, 0}, nullptr};
      break;
    case 1:
      o.shape = {ShapeKind::kBox, {uniform(rng, 0.1, 0.4), uniform(rng, 0.1, 0.4), uniform(rng, 0.1, 1.0)}, nullptr};
      break;
    case 2:
      o.shape = {ShapeKind::kCylinder, {uniform(rng, 0.04, 0.2), uniform(rng, 0.1, 0.6), 0}, nullptr};
      break;
    default:
      o.shape = {ShapeKind::kCapsule, {uniform(rng, 0.04, 0.12), uniform(rng, 0.1, 0.6), 0}, nullptr};
  }
  return o;
}

/// So many of all kinds, named o0, o1, ...
inline std::vector<ObjectShape> random_objects(Rng& rng, std::size_t count) {
  std::vector<ObjectShape> objects;
  for (std::size_t i = 0; i < count; ++i) objects.push_back(random_object(rng, std::string("o") + std::to_string(i)));
  return objects;
}

/// Where an object is after `dt` seconds [s] of its twist.
inline Isometry moved_pose(const ObjectState& object, double dt) {
  Isometry X_WO = object.X_WO;
  const Vector3 turn = object.V_WO_W.head<3>() * dt;
  if (turn.norm() > 0) X_WO.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * X_WO.linear();
  X_WO.translation() += object.V_WO_W.tail<3>() * dt;
  return X_WO;
}

/// A random state, goal and placement of `objects` within `spread` of the end effector's neighbourhood.
inline Observation random_observation(const RobotModel& model, std::size_t objects, Rng& rng, double spread = 1.2) {
  Observation o;
  o.base = model.base_dof() > 0 ? Vector3(uniform(rng, -2, 2), uniform(rng, -2, 2), uniform(rng, -kPi, kPi))
                                : Vector3::Zero();
  o.q = random_joints(model, rng, 0.02);
  o.qdot = VectorX::NullaryExpr(model.num_velocities(), [&] { return uniform(rng, -0.5, 0.5); });
  const VectorX limit = model.velocity_limits();
  o.qdot = o.qdot.cwiseMax(-limit).cwiseMin(limit);
  o.goal.X_WG.linear() = random_rotation(rng);
  o.goal.X_WG.translation() = o.base.cwiseProduct(Vector3(1, 1, 0)) + random_vector(rng, 1.5) + Vector3(0, 0, 1.0);
  o.goal.V_WG_W.head<3>() = random_vector(rng, 0.1);
  o.goal.V_WG_W.tail<3>() = random_vector(rng, 0.1);
  for (std::size_t i = 0; i < objects; ++i) {
    ObjectState s;
    s.X_WO.linear() = random_rotation(rng);
    s.X_WO.translation() = o.base.cwiseProduct(Vector3(1, 1, 0)) + random_vector(rng, spread) + Vector3(0, 0, 0.7);
    s.V_WO_W.head<3>() = random_vector(rng, 0.3);
    s.V_WO_W.tail<3>() = random_vector(rng, 0.2);
    o.objects.push_back(s);
  }
  return o;
}

}  // namespace moma::test
