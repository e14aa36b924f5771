#include <array>
#include <optional>
#include <string>

#include "controller/config/json_node.h"
#include "controller/config/read_described.h"
#include "controller/config/robot_build.h"
#include "controller/config/robot_file.h"
#include "controller/config/write_described.h"
#include "controller/model/base_kind.h"

namespace moma {

constexpr void describe(auto& v, Of<Wheels>) {
  using T = Wheels;
  v.member("radius", &T::radius, positive("m", "of the wheels"));
  v.member("separation", &T::separation, positive("m", "from left to right wheels"));
  v.member("wheelbase", &T::wheelbase, non_negative("m", "from front to rear wheels"));
  v.member("max_speed", &T::max_speed, positive("rad/s", "of a wheel"));
  v.member("width", &T::width, unless_default(positive("m", "of a wheel")));
}

// Reads the keys beside `type`, `mount` and `footprint`.
constexpr void describe(auto& v, Of<MobileBase>) {
  using T = MobileBase;
  v.member("wheels", &T::wheels, {});
  v.member("max_linear", &T::max_linear, positive("m/s", "greatest speed"));
  v.member("max_angular", &T::max_angular, positive("rad/s", "greatest turning speed"));
  v.member("max_acceleration", &T::max_acceleration, positive("m/s^2, rad/s^2", "how the drive ramps a command"));
}

}  // namespace moma

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

Isometry isometry_of(const WrittenPose& pose, MapReader& in) {
  in.check(in.get("rpy") == nullptr || !pose.rotation, "rotation", "give `rpy` or `rotation`, not both");
  Isometry X = pose_of(rotation_of(pose.rpy), pose.position);
  if (!pose.rotation) return X;
  X.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation->data());
  const double defect = (X.linear() * X.linear().transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  in.check(defect < 1e-9 && X.linear().determinant() > 0.0, "rotation", "these nine numbers are no rotation matrix");
  return X;
}

}  // namespace

Matrix3 rotation_of(const Vector3& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
      .toRotationMatrix();
}

Isometry read_pose(MapReader& in) {
  WrittenPose pose;
  read_members(in, pose);
  return isometry_of(pose, in);
}

void read_pose(MapReader& outer, const char* name, Isometry& X, Json& written) {
  if (outer.get(name) == nullptr) return;
  MapReader in(outer, name);
  WrittenPose pose;
  read_members(in, pose);
  in.finish();
  X = isometry_of(pose, in);
  written[name] = write_described(pose);
}

void read_base(MapReader& robot, RobotBuild& build) {
  MapReader in(robot, "base");
  MobileBase& base = build.model.base;
  Json& written = as_object(build.resolved["base"]);
  in.read_enum("type", base.type);
  written["type"] = to_string(base.type);
  read_pose(in, "mount", base.X_BM, written);
  if (build.model.mobile()) {
    in.require("max_linear", "the base's largest speed [m/s]");
    in.require("max_angular", "the base's largest turning speed [rad/s]");
  }
  read_members(in, base);
  if (base.wheels && kind_of(base.type).wheelbase) {
    MapReader wheels(in, "wheels");
    wheels.require("wheelbase", "the distance of front and rear wheels [m]");
    wheels.check(base.wheels->wheelbase > 0.0, "wheelbase", "mecanum wheels need a number above 0");
  }
  if (build.model.mobile()) {
    write_members(base, written);
  } else {
    if (base.max_linear > 0.0 || base.max_angular > 0.0 || base.wheels)
      build.warnings.emplace_back("base: speeds and wheels are left aside, since its type is fixed");
    base.max_linear = base.max_angular = 0.0;
    base.wheels.reset();
  }
  in.get("footprint");  // read with the other collision shapes
  in.finish();
}

}  // namespace moma::config
