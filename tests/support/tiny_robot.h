#pragma once

#include <memory>

#include "controller/config/robot_file.h"
#include "controller/model/robot_model.h"

namespace moma::test {

/// A differential base with an arm of two revolute joints (z, then y axis) and one sliding joint, each 0.3 m on;
/// spheres of 5 cm at the links. Small enough to check by hand: at q = 0 the tip is at (0.3 + 0.3 + 0.3, 0, 0.5).
inline std::shared_ptr<const RobotModel> tiny_robot() {
  auto model = std::make_shared<RobotModel>();
  model->name = "tiny";
  model->base.type = BaseType::kDifferential;
  model->base.max_linear = 1.0;
  model->base.max_angular = 2.0;
  model->base.wheels = Wheels{};
  model->base.mass = 50.0;
  const auto add_link = [&](const char* name, int parent, const char* joint, JointType type, const Vector3& offset,
                            const Vector3& axis, int controlled) {
    Link link;
    link.name = name;
    link.parent = parent;
    link.joint = joint;
    link.joint_type = type;
    link.X_PJ.translation() = offset;
    link.axis = axis;
    link.controlled = controlled;
    model->links.push_back(link);
  };
  add_link("@base", -1, "", JointType::kFixed, Vector3::Zero(), Vector3::UnitZ(), -1);
  model->base.X_BM.translation() = Vector3(0, 0, 0.5);
  add_link("root", 0, "", JointType::kFixed, model->base.X_BM.translation(), Vector3::UnitZ(), -1);
  add_link("upper", 1, "turn", JointType::kRevolute, Vector3::Zero(), Vector3::UnitZ(), 0);
  add_link("lower", 2, "bend", JointType::kRevolute, Vector3(0.3, 0, 0), Vector3::UnitY(), 1);
  add_link("slide", 3, "reach", JointType::kPrismatic, Vector3(0.3, 0, 0), Vector3::UnitX(), 2);
  model->joints = {{"turn", JointType::kRevolute, 2, -2.0, 2.0, 1.5, 50.0},
                   {"bend", JointType::kRevolute, 3, -1.0, 1.0, 1.5, 50.0},
                   {"reach", JointType::kPrismatic, 4, -0.2, 0.4, 0.5, 50.0}};
  model->tip = 4;
  model->X_TE.translation() = Vector3(0.3, 0, 0);
  model->ready = VectorX::Zero(3);
  const auto add_shape = [&](const char* name, int link, bool rigid) {
    CollisionShape shape;
    shape.name = name;
    shape.link = link;
    shape.shape.kind = ShapeKind::kSphere;
    shape.shape.size = Vector3(0.05, 0, 0);
    shape.rigid_with_base = rigid;
    model->shapes.push_back(shape);
  };
  add_shape("@base", 0, true);
  add_shape("upper", 2, false);
  add_shape("lower", 3, false);
  add_shape("slide", 4, false);
  model->shapes[0].X_LS.translation() = Vector3(0, 0, 0.1);
  model->self_pairs = {{0, 3, true}, {1, 3, true}};
  return model;
}

inline std::shared_ptr<const config::LoadedRobot> tiny_loaded_robot() {
  auto robot = std::make_shared<config::LoadedRobot>();
  robot->model = tiny_robot();
  robot->resolved = {{"name", "tiny"}};
  return robot;
}

}  // namespace moma::test
