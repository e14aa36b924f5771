#include <string>
#include <string_view>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/config/robot_build.h"
#include "controller/config/robot_file.h"
#include "controller/model/base_kind.h"

namespace moma::config {
namespace {

Vector3 read_vector(MapReader& in, std::string_view name, const Vector3& otherwise) {
  const Node* node = in.get(name);
  if (node == nullptr) return otherwise;
  const std::vector<double> v = read_numbers(*node, in.key_of(name), 3);
  return {v[0], v[1], v[2]};
}

void read_wheels(MapReader& base, MobileBase& model, nlohmann::ordered_json& written) {
  const Node* node = base.get("wheels");
  if (node == nullptr) return;
  MapReader in(*node, base.key_of("wheels"));
  Wheels wheels;
  in.read("radius", wheels.radius, Range::positive());
  in.read("separation", wheels.separation, Range::positive());
  in.read("max_speed", wheels.max_speed, Range::positive());
  const bool wheelbase = kind_of(model.type).wheelbase;
  if (wheelbase) in.require("wheelbase", "the distance of front and rear wheels [m]");
  in.read("wheelbase", wheels.wheelbase, Range::non_negative());
  in.check(!wheelbase || wheels.wheelbase > 0.0, "wheelbase", "mecanum wheels need a number above 0");
  double width = 0.0;
  const bool wide = in.get("width") != nullptr;  // read_collision() makes shapes of them
  in.read("width", width, Range::positive());
  in.finish();
  written["wheels"] = {{"radius", wheels.radius},
                       {"separation", wheels.separation},
                       {"wheelbase", wheels.wheelbase},
                       {"max_speed", wheels.max_speed}};
  if (wide) written["wheels"]["width"] = width;
  model.wheels = wheels;
}

}  // namespace

Matrix3 rotation_of(const Vector3& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
      .toRotationMatrix();
}

nlohmann::ordered_json to_json_list(const Eigen::Ref<const VectorX>& values) {
  auto list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(number_to_json(value));
  return list;
}

Isometry read_pose(MapReader& in, nlohmann::ordered_json& written) {
  written = nlohmann::ordered_json::object();
  Isometry X = Isometry::Identity();
  X.translation() = read_vector(in, "position", Vector3::Zero());
  written["position"] = to_json_list(X.translation());
  const Node* rpy = in.get("rpy");
  const Node* matrix = in.get("rotation");
  in.check(rpy == nullptr || matrix == nullptr, "rotation", "give `rpy` or `rotation`, not both");
  if (matrix != nullptr) {
    const std::vector<double> r = read_numbers(*matrix, in.key_of("rotation"), 9);
    X.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
    const double defect = (X.linear() * X.linear().transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
    in.check(defect < 1e-9 && X.linear().determinant() > 0.0, "rotation", "these nine numbers are no rotation matrix");
    written["rotation"] = to_json_list(Eigen::Map<const VectorX>(r.data(), 9));
  } else {
    const Vector3 angles = read_vector(in, "rpy", Vector3::Zero());
    X.linear() = rotation_of(angles);
    written["rpy"] = to_json_list(angles);
  }
  return X;
}

void read_base(MapReader& robot, RobotBuild& build) {
  static const Node kNone;
  const Node* node = robot.get("base");
  MapReader in(node != nullptr ? *node : kNone, robot.key_of("base"));
  MobileBase& base = build.model.base;
  nlohmann::ordered_json& written = as_object(build.resolved["base"]);
  in.read_enum("type", base.type);
  written["type"] = std::string(to_string(base.type));
  if (const Node* mount = in.get("mount")) {
    MapReader at(*mount, in.key_of("mount"));
    base.X_BM = read_pose(at, written["mount"]);
    at.finish();
  }
  const bool mobile = build.model.mobile();
  if (mobile) {
    in.require("max_linear", "the base's largest speed [m/s]");
    in.require("max_angular", "the base's largest turning speed [rad/s]");
  }
  in.read("max_linear", base.max_linear, Range::positive());
  in.read("max_angular", base.max_angular, Range::positive());
  if (const Node* acceleration = in.get("max_acceleration")) {
    const auto a = read_numbers(*acceleration, in.key_of("max_acceleration"), 2, Range::positive());
    base.max_acceleration = Vector2(a[0], a[1]);
  }
  read_wheels(in, base, written);
  if (mobile) {
    written["max_linear"] = base.max_linear;
    written["max_angular"] = base.max_angular;
    written["max_acceleration"] = to_json_list(base.max_acceleration);
  } else {
    if (base.max_linear > 0.0 || base.max_angular > 0.0 || base.wheels)
      build.warnings.emplace_back("base: speeds and wheels are left aside, since its type is fixed");
    base.max_linear = base.max_angular = 0.0;
    base.wheels.reset();
    written.erase("wheels");
  }
  in.get("footprint");  // read with the other collision shapes
  in.finish();
}

}  // namespace moma::config
