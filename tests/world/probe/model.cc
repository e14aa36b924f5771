#include <cmath>
#include <map>
#include <string>

#include "controller/config/robot_file.h"
#include "tests/world/probe/probe.h"
#include "world/plant/ode_arm.h"
#include "world/plant/ode_base.h"

namespace moma::probe {
namespace {

using nlohmann::json;

json vector(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

json matrix(const Matrix3& R) {
  json out = json::array();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.push_back(R(i, j));
  return out;
}

json pose(const Isometry& X) { return {{"position", vector(X.translation())}, {"rotation", matrix(X.linear())}}; }

json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

json link_json(const RobotModel& model, const Link& link) {
  json out = {{"name", link.name},         {"parent", link.parent},
              {"X_PJ", pose(link.X_PJ)},   {"type", std::string(to_string(link.joint_type))},
              {"axis", vector(link.axis)}, {"held", link.held}};
  if (link.controlled >= 0) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(link.controlled)];
    out["joint"] = {{"name", joint.name},
                    {"lower", number_or_null(joint.lower)},
                    {"upper", number_or_null(joint.upper)},
                    {"velocity", joint.velocity},
                    {"effort", joint.effort}};
  }
  if (link.inertial)
    out["inertial"] = {
        {"mass", link.inertial->mass}, {"com", vector(link.inertial->com_L)}, {"inertia", matrix(link.inertial->I_C)}};
  return out;
}

/// Where the plant puts what the robot file does not place.
json support(const RobotModel& model) {
  json out = {{"wheel_mass", 0.5 * OdeBase::own_mass(model)}};
  if (model.base.type != BaseType::kDifferential || !model.base.wheels) return out;
  const Wheels& wheels = *model.base.wheels;
  out["wheels"] = {{"radius", wheels.radius}, {"separation", wheels.separation}, {"max_speed", wheels.max_speed}};
  out["caster_radius"] = 0.5 * wheels.radius;
  for (const Vector2& p : OdeSupport::corners(model, 0.5 * wheels.radius, true))
    out["casters"].push_back({p.x(), p.y()});
  return out;
}

}  // namespace

std::shared_ptr<const RobotModel> robot_of(const json& request) {
  static std::map<std::string, std::shared_ptr<const RobotModel>> known;
  const auto file = request.at("robot").get<std::string>();
  auto& model = known[file];
  if (!model) model = config::load_robot(file).model;
  auto copy = std::make_shared<RobotModel>(*model);
  if (request.value("held", false)) copy->base.type = BaseType::kFixed;
  if (request.contains("max_acceleration"))
    copy->base.max_acceleration =
        Vector2(request.at("max_acceleration").at(0).get<double>(), request.at("max_acceleration").at(1).get<double>());
  return copy;
}

json model(const json& request) {
  const std::shared_ptr<const RobotModel> robot = robot_of(request);
  const RobotModel& model = *robot;
  json out = {{"name", model.name},
              {"base",
               {{"type", std::string(to_string(model.base.type))},
                {"mass", model.base.mass},
                {"max_acceleration", {model.base.max_acceleration.x(), model.base.max_acceleration.y()}}}},
              {"ready", std::vector<double>(model.ready.data(), model.ready.data() + model.ready.size())},
              {"gravity", 9.81},
              {"wheel_friction", 1.0},
              {"object_friction", 0.5},
              {"support", support(model)}};
  for (const Link& link : model.links) out["links"].push_back(link_json(model, link));
  for (const ControlledJoint& joint : model.joints) out["joints"].push_back(joint.name);
  out["shapes"] = json::array();
  for (const CollisionShape& shape : model.shapes)
    out["shapes"].push_back({{"name", shape.name},
                             {"link", shape.link},
                             {"kind", std::string(to_string(shape.shape.kind))},
                             {"size", vector(shape.shape.size)},
                             {"X_LS", pose(shape.X_LS)},
                             {"rigid_with_base", shape.rigid_with_base}});
  out["self_pairs"] = json::array();
  for (const SelfPair& pair : model.self_pairs) out["self_pairs"].push_back({pair.first, pair.second});
  return out;
}

}  // namespace moma::probe
