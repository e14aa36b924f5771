#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "tests/support/coal_distance.h"
#include "tests/world/support.h"
#include "world/scenario/scene_builder.h"

namespace moma::test {

/// What the generator promises of a world, looked at again by coal pair by pair and by forward kinematics.
class WorldProof {
 public:
  explicit WorldProof(std::shared_ptr<const RobotModel> model)
      : model_(std::move(model)), start_(model_), witness_(model_) {}

  /// Start and witness keep off the floor, off themselves and `clearance` off every object, wherever it is at any of
  /// the times 0, step, 2 step, ... horizon, or `at_witness` off the witness if that is given; the witness is within
  /// its limits and its tool at the goal.
  void check(const World& world, double clearance, double horizon, double step, std::optional<double> at_witness = {}) {
    place(world, clearance, at_witness.value_or(clearance));
    ASSERT_NO_FATAL_FAILURE(check_pose(start_, 0.0, 0.0, "start"));
    ASSERT_NO_FATAL_FAILURE(check_pose(witness_, 0.02, 0.01, "witness"));
    ASSERT_LT((witness_.X_WE().matrix() - goal_state(world, 0.0).X_WG.matrix()).norm(), 1e-12) << "goal and witness";
    for (int j = 0; j < model_->num_joints(); ++j) {
      const ControlledJoint& joint = model_->joints[static_cast<std::size_t>(j)];
      ASSERT_GE(world.witness.q[j], joint.lower) << "joint " << j;
      ASSERT_LE(world.witness.q[j], joint.upper) << "joint " << j;
    }
    for (const WorldObject& object : world.objects)
      ASSERT_NO_FATAL_FAILURE(check_object(object, at_rest(object.motion, 0.0) ? 0.0 : horizon, step));
  }

  /// Least distance of the witness's shapes to the objects at t = 0.
  double least_at_witness(const World& world) {
    witness_.update(world.witness.base, world.witness.q);
    double least = std::numeric_limits<double>::infinity();
    for (const CollisionShape& shape : model_->shapes)
      for (const WorldObject& object : world.objects)
        least = std::min(least, coal_distance(shape.shape, witness_.X_WS(shape), object.shape, object.X_WO));
    return least;
  }

 private:
  // coal stops within its tolerance of the distance.
  static constexpr double kTolerance = 1e-6;
  static constexpr double kFastest = 3.0;  // of an object, which is looked at seldom where it is far [m/s]

  struct Placed {
    const CollisionShape* shape;
    const char* who;
    Isometry X_WS;
    double reach, level_reach;
    double clearance;
  };

  void place(const World& world, double at_start, double at_witness) {
    start_.update(world.start.base, world.start.q);
    witness_.update(world.witness.base, world.witness.q);
    placed_.clear();
    for (const CollisionShape& shape : model_->shapes) {
      add(shape, "start ", start_.X_WS(shape), at_start);
      add(shape, "witness ", witness_.X_WS(shape), at_witness);
    }
  }

  void add(const CollisionShape& shape, const char* who, const Isometry& X_WS, double clearance) {
    placed_.push_back({&shape, who, X_WS, reach(shape.shape), level_reach(shape.shape, X_WS), clearance});
  }

  void check_pose(const Kinematics& kinematics, double floor, double self, const char* who) {
    for (const CollisionShape& shape : model_->shapes)
      if (!shape.rigid_with_base) {
        ASSERT_GE(lowest(shape.shape, kinematics.X_WS(shape)), floor - 1e-9) << who << " " << shape.name;
      }
    for (const SelfPair& pair : model_->self_pairs) {
      const CollisionShape& a = model_->shapes[static_cast<std::size_t>(pair.first)];
      const CollisionShape& b = model_->shapes[static_cast<std::size_t>(pair.second)];
      if (apart(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)) > self) continue;
      ASSERT_GE(coal_distance(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)), self - kTolerance)
          << who << " " << a.name << " " << b.name;
    }
  }

  void check_object(const WorldObject& object, double horizon, double step) {
    // What goes straight is looked at every kTimeStep as it is made, and may come nearer by a step in between.
    const auto* straight = std::get_if<LinearMotion>(&object.motion);
    const double between = straight != nullptr ? straight->V_W.tail<3>().norm() * SceneBuilder::kTimeStep : 0.0;
    const double size = reach(object.shape);
    Vector3 before = object.X_WO.translation();
    int steps = 0;  // passed over since the look before
    for (int k = 0; k * step <= horizon; k += steps) {
      const double t = k * step;
      const Isometry X_WO = evaluate(object.motion, object.X_WO, t).X;
      ASSERT_TRUE(X_WO.matrix().allFinite()) << object.name << " at " << t;
      ASSERT_LE((X_WO.translation() - before).norm(), kFastest * steps * step + 1e-9) << object.name << " at " << t;
      before = X_WO.translation();
      const double level = level_reach(object.shape, X_WO);
      double away = std::numeric_limits<double>::infinity();
      for (const Placed& part : placed_) {
        // Spheres or upright cylinders about both, and a little for rounding.
        const Vector3 way = part.X_WS.translation() - before;
        const double gap =
            std::max(way.norm() - part.reach - size, way.head<2>().norm() - part.level_reach - level) - part.clearance;
        away = std::min(away, gap);
        if (gap > 1e-9) continue;
        ASSERT_GE(coal_distance(part.shape->shape, part.X_WS, object.shape, X_WO),
                  part.clearance - between - kTolerance)
            << part.who << part.shape->name << " " << object.name << " at " << t;
      }
      steps = 1 + std::max(0, static_cast<int>(away / (kFastest * step)));  // before which it is too far
    }
  }

  /// A bound from below: spheres about both.
  static double apart(const Shape& a, const Isometry& X_WA, const Shape& b, const Isometry& X_WB) {
    return (X_WA.translation() - X_WB.translation()).norm() - reach(a) - reach(b);
  }
  static double reach(const Shape& shape) {
    if (shape.kind == ShapeKind::kSphere) return shape.size.x();
    if (shape.kind == ShapeKind::kBox) return 0.5 * shape.size.norm();
    return shape.size.x() + 0.5 * shape.size.y();
  }
  /// Radius of an upright cylinder about it.
  static double level_reach(const Shape& shape, const Isometry& X) {
    if (shape.kind == ShapeKind::kSphere) return shape.size.x();
    if (shape.kind == ShapeKind::kBox) return 0.5 * (X.linear().topRows<2>().cwiseAbs() * shape.size).norm();
    return shape.size.x() + 0.5 * shape.size.y() * X.linear().col(2).head<2>().norm();
  }
  /// Height of the lowest point, over the sphere of a capsule's or the rim of a cylinder's lower end.
  static double lowest(const Shape& shape, const Isometry& X) {
    const Vector3 up = X.linear().row(2).transpose().cwiseAbs();
    const double z = X.translation().z();
    if (shape.kind == ShapeKind::kSphere) return z - shape.size.x();
    if (shape.kind == ShapeKind::kBox) return z - 0.5 * up.dot(shape.size);
    const double end = z - 0.5 * shape.size.y() * up.z();
    if (shape.kind == ShapeKind::kCapsule) return end - shape.size.x();
    return end - shape.size.x() * std::hypot(up.x(), up.y());
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics start_, witness_;
  std::vector<Placed> placed_;
};

}  // namespace moma::test
