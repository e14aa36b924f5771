#pragma once

#include <memory>

#include "controller/model/robot_model.h"
#include "world/draws.h"
#include "world/world.h"

// Two solids as a robot and its world, for tests of contacts.
namespace moma::test {

/// A "robot" that is one solid, on a slide that could lift it, so that it has to keep off the floor.
inline std::shared_ptr<const RobotModel> one_solid(const Shape& shape, const Isometry& X) {
  auto model = std::make_shared<RobotModel>();
  model->name = "solid";
  Link base, root;
  base.name = "@base";
  root.name = "root";
  root.parent = 0;
  root.joint = "lift";
  root.joint_type = JointType::kPrismatic;
  root.controlled = 0;
  model->links = {base, root};
  ControlledJoint lift;
  lift.name = "lift";
  lift.type = JointType::kPrismatic;
  lift.link = 1;
  lift.lower = -1.0;
  lift.upper = 1.0;
  lift.velocity = 1.0;
  model->joints = {lift};
  model->tip = 1;
  model->ready = VectorX::Zero(1);
  CollisionShape solid;
  solid.name = "solid";
  solid.shape = shape;
  solid.link = 1;
  solid.X_LS = X;
  model->shapes = {solid};
  return model;
}

/// A world that holds one solid.
inline World one_object(const Shape& shape, const Isometry& X) {
  World world;
  WorldObject object;
  object.name = "object";
  object.shape = shape;
  object.X_WO = X;
  world.start.q = VectorX::Zero(1);  // of one_solid()
  world.objects = {object};
  return world;
}

inline Shape random_shape(ShapeKind kind, Draws& draws) {
  Shape shape;
  shape.kind = kind;
  for (int i = 0; i < 3; ++i) shape.size[i] = draws.uniform(0.05, 0.4);
  if (kind == ShapeKind::kSphere) shape.size.tail<2>().setZero();
  if (kind == ShapeKind::kCapsule || kind == ShapeKind::kCylinder) shape.size[2] = 0.0;
  return shape;
}

}  // namespace moma::test
