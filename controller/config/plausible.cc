#include "controller/config/plausible.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

namespace moma::config {
namespace {

constexpr const char* kDegrees = ": degrees?";
constexpr const char* kMillimetres = ": millimetres?";
constexpr const char* kGrams = ": grams?";

// Ranges for arms and for robots on wheels with an arm, from desk arms to forklifts.
constexpr Usual kAngle{-2.0 * std::numbers::pi, 2.0 * std::numbers::pi, "rad", kDegrees};
constexpr Usual kMount{-3.0, 3.0, "m", kMillimetres};
constexpr Usual kLength{0.0, 3.0, "m", kMillimetres};
constexpr Usual kTool{0.0, 2.0, "m", kMillimetres};
constexpr Usual kLowest{-0.01, 0.3, "m", ": in the floor, or over it?"};
constexpr Usual kWheelRadius{0.02, 0.6, "m"};
constexpr Usual kWheelDistance{0.05, 3.0, "m"};
constexpr Usual kWheelSpeed{0.5, 300.0, "rad/s"};
constexpr Usual kSpeed{0.05, 6.0, "m/s"};
constexpr Usual kTurning{0.05, 12.0, "rad/s", kDegrees};
constexpr Usual kAcceleration{0.02, 30.0, "m/s^2"};
constexpr Usual kTurningAcceleration{0.02, 100.0, "rad/s^2", kDegrees};
constexpr Usual kBaseMass{1.0, 5000.0, "kg", kGrams};
constexpr Usual kLinkMass{0.0, 500.0, "kg", kGrams};
constexpr Usual kJointAngle{-8.0 * std::numbers::pi, 8.0 * std::numbers::pi, "rad", kDegrees};
constexpr Usual kJointTravel{-5.0, 5.0, "m", kMillimetres};
constexpr Usual kJointSpeed{0.01, 40.0, "rad/s", kDegrees};
constexpr Usual kJointTravelSpeed{0.001, 5.0, "m/s", kMillimetres};

using Sentences = std::vector<std::string>;

void look(Sentences& out, const std::string& what, double value, const Usual& usual, const char* whose = "robots") {
  if (std::string text = unusual(what, value, usual, whose); !text.empty()) out.push_back(std::move(text));
}

/// Every `rpy` below `json`, by its key.
void look_at_angles(Sentences& out, const Json& json, const std::string& key) {
  if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i)  // a mesh has thousands of plain numbers
      if (json[i].is_structured()) look_at_angles(out, json[i], key + "." + std::to_string(i));
    return;
  }
  if (!json.is_object()) return;
  for (const auto& [name, value] : json.items()) {
    const std::string here = key.empty() ? name : key + "." + name;
    if (name != "rpy") {
      look_at_angles(out, value, here);
      continue;
    }
    for (const auto& angle : value)
      if (angle.is_number()) look(out, here, angle.get<double>(), kAngle);
  }
}

void look_at_base(Sentences& out, const MobileBase& base) {
  for (const double part : base.X_BM.translation()) look(out, "base.mount.position", part, kMount);
  if (base.wheels) {
    look(out, "base.wheels.radius", base.wheels->radius, kWheelRadius);
    look(out, "base.wheels.separation", base.wheels->separation, kWheelDistance);
    if (base.wheels->wheelbase > 0.0) look(out, "base.wheels.wheelbase", base.wheels->wheelbase, kWheelDistance);
    look(out, "base.wheels.max_speed", base.wheels->max_speed, kWheelSpeed);
  }
  if (base.max_linear > 0.0) {
    const double by_wheels = base.wheels ? 1.001 * base.wheels->radius * base.wheels->max_speed : kSpeed.high;
    if (base.max_linear > by_wheels)
      look(out, "base.max_linear", base.max_linear, {0.0, by_wheels, "m/s", " by radius x max_speed"}, "these wheels");
    else
      look(out, "base.max_linear", base.max_linear, kSpeed);
    look(out, "base.max_angular", base.max_angular, kTurning);
    look(out, "base.max_acceleration", base.max_acceleration.x(), kAcceleration);
    look(out, "base.max_acceleration", base.max_acceleration.y(), kTurningAcceleration);
  }
  if (base.mass > 0.0) look(out, "base.footprint.mass", base.mass, kBaseMass);
}

/// A body's principal moments of inertia are positive, and none is more than the other two together. Files round them.
void look_at_inertia(Sentences& out, const Link& link) {
  constexpr double kRounding = 0.05;
  const Matrix3& I = link.inertial->I_C;
  if (I.isZero(0.0)) return;
  const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(I, Eigen::EigenvaluesOnly).eigenvalues();
  const double most = moments.cwiseAbs().maxCoeff();
  const bool body =
      moments[0] > -kRounding * most && moments[2] <= moments[0] + moments[1] + kRounding * most && moments[2] > 0.0;
  if (body) return;
  std::ostringstream text;
  text.precision(4);
  text << "link " << link.name << ": inertia: its principal moments, " << moments[0] << ", " << moments[1] << " and "
       << moments[2] << " kg m^2, are those of no body: none is negative, and none is more than the other two together";
  out.push_back(text.str());
}

// Height of the base's own shapes over the floor. The footprint is the first of them, where the file has one; wheels,
// which always stand on the floor, follow.
void look_at_footprint(Sentences& out, const RobotModel& model, const Json& resolved) {
  const bool footprint = resolved.contains("base") && resolved["base"].contains("footprint");
  double lowest = std::numeric_limits<double>::infinity();
  for (const CollisionShape& shape : model.shapes) {
    if (shape.link != 0) continue;
    lowest = std::min(lowest, lowest_point(shape.shape, shape.X_LS));
    if (footprint) break;
  }
  look(out, "base.footprint: its lowest point", lowest, kLowest);
}

}  // namespace

std::string unusual(const std::string& what, double value, const Usual& usual, const char* whose) {
  if (!std::isfinite(value) || (value >= usual.low && value <= usual.high)) return "";
  std::ostringstream text;
  text.precision(4);
  text << what << ": " << value << ' ' << usual.unit << " is unusual, where " << whose << " have " << usual.low
       << " to " << usual.high << ' ' << usual.unit << usual.hint;
  return text.str();
}

std::vector<std::string> implausible(const RobotModel& model, const Json& resolved) {
  Sentences out;
  look_at_angles(out, resolved, "");
  look_at_base(out, model.base);
  look_at_footprint(out, model, resolved);
  look(out, "arm.tool: its distance from the tip", model.X_TE.translation().norm(), kTool);
  for (std::size_t l = 2; l < model.links.size(); ++l) {  // the root hangs at the mount
    const Link& link = model.links[l];
    look(out, "joint " + link.joint + ": the way from its parent's", link.X_PJ.translation().norm(), kLength);
  }
  for (const Link& link : model.links) {
    if (!link.inertial) continue;
    look(out, "link " + link.name + ": mass", link.inertial->mass, kLinkMass);
    look_at_inertia(out, link);
  }
  for (const ControlledJoint& joint : model.joints) {
    const bool slides = joint.type == JointType::kPrismatic;
    for (const double limit : {joint.lower, joint.upper})
      if (std::isfinite(limit))
        look(out, "joint " + joint.name + ": limit", limit, slides ? kJointTravel : kJointAngle);
    look(out, "joint " + joint.name + ": velocity", joint.velocity, slides ? kJointTravelSpeed : kJointSpeed);
  }
  for (const CollisionShape& shape : model.shapes)
    look(out, "shape " + shape.name + ": size", shape.shape.size.cwiseAbs().maxCoeff(), kLength);
  return out;
}

}  // namespace moma::config
