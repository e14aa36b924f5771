#include <array>
#include <optional>
#include <string>

#include "controller/config/json_node.h"
#include "controller/config/read_described.h"
#include "controller/config/robot_build.h"
#include "controller/config/robot_file.h"
#include "controller/config/write_described.h"
#include "controller/model/base_kind.h"

namespace moma::config {
namespace {

struct WrittenPose {
  Vector3 position = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
  std::optional<std::array<double, 9>> rotation;  // row by row, in place of rpy
};

constexpr void describe(auto& v, Of<WrittenPose>) {
  using T = WrittenPose;
  v.member("position", &T::position, {.unit = "m"});
  v.written_where([](const T& pose) { return !pose.rotation; },
                  [](auto& g) { g.member("rpy", &T::rpy, {.unit = "rad"}); });
  v.member("rotation", &T::rotation, {});
}

void read_wheels(MapReader& base, MobileBase& model, Json& written) {
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

Isometry read_pose(MapReader& in, Json& written) {
  WrittenPose pose;
  read_members(in, pose);
  in.check(in.get("rpy") == nullptr || !pose.rotation, "rotation", "give `rpy` or `rotation`, not both");
  Isometry X = Isometry::Identity();
  X.translation() = pose.position;
  X.linear() = rotation_of(pose.rpy);
  if (pose.rotation) {
    X.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation->data());
    const double defect = (X.linear() * X.linear().transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
    in.check(defect < 1e-9 && X.linear().determinant() > 0.0, "rotation", "these nine numbers are no rotation matrix");
  }
  written = write_described(pose);
  return X;
}

void read_base(MapReader& robot, RobotBuild& build) {
  static const Node kNone;
  const Node* node = robot.get("base");
  MapReader in(node != nullptr ? *node : kNone, robot.key_of("base"));
  MobileBase& base = build.model.base;
  Json& written = as_object(build.resolved["base"]);
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
  if (const Node* a = in.get("max_acceleration"))
    base.max_acceleration = Vector2(read_numbers(*a, in.key_of("max_acceleration"), 2, Range::positive()).data());
  read_wheels(in, base, written);
  if (mobile) {
    written["max_linear"] = base.max_linear;
    written["max_angular"] = base.max_angular;
    written["max_acceleration"] = description::list_to_json(numbers_of(base.max_acceleration));
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
