#include "world/plant/rigid_bodies.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

namespace moma {
namespace {

/// Adds a part to a body: masses, centres and inertias about the common centre (parallel axes).
void add(RigidBody& body, double mass, const Vector3& com, const Matrix3& I_com) {
  const auto shifted = [](double m, const Vector3& r) -> Matrix3 {
    return m * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  };
  const double total = body.mass + mass;
  if (!(total > 0.0)) return;
  const Vector3 center = (body.mass * body.com_L + mass * com) / total;
  body.I_C += shifted(body.mass, body.com_L - center) + I_com + shifted(mass, com - center);
  body.mass = total;
  body.com_L = center;
}

struct Volume {
  double volume;
  Vector3 inertia;  // principal moments at unit mass about the shape's origin
};

Volume volume_of(const Shape& shape) {
  constexpr double kPi = std::numbers::pi;
  const double r = shape.size.x();
  const double l = shape.size.y();
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return {4.0 / 3.0 * kPi * r * r * r, Vector3::Constant(0.4 * r * r)};
    case ShapeKind::kCylinder: {
      const double side = (3.0 * r * r + l * l) / 12.0;
      return {kPi * r * r * l, {side, side, 0.5 * r * r}};
    }
    case ShapeKind::kCapsule: {
      const double cylinder = kPi * r * r * l;
      const double caps = 4.0 / 3.0 * kPi * r * r * r;
      const double volume = cylinder + caps;
      const double side =
          (cylinder * (3.0 * r * r + l * l) / 12.0 + caps * (0.4 * r * r + 0.25 * l * l + 0.375 * r * l)) / volume;
      return {volume, {side, side, (cylinder * 0.5 * r * r + caps * 0.4 * r * r) / volume}};
    }
    case ShapeKind::kBox:
    case ShapeKind::kConvex:
      break;
  }
  Vector3 edges = shape.size;
  if (shape.kind == ShapeKind::kConvex) {  // a hull is replaced by its bounding box about its origin
    edges.setConstant(1e-3);
    for (const Vector3& v : shape.hull->vertices) edges = edges.cwiseMax(2.0 * v.cwiseAbs());
  }
  const Vector3 squared = edges.cwiseAbs2();
  return {edges.prod(),
          Vector3(squared.y() + squared.z(), squared.x() + squared.z(), squared.x() + squared.y()) / 12.0};
}

void add_base_mass(const RobotModel& model, double mass, RigidBody& body) {
  double volume = 0.0;
  for (const CollisionShape& shape : model.shapes)
    if (shape.link == 0) volume += volume_of(shape.shape).volume;
  if (!(model.base.mass > 0.0)) {
    if (!(volume > 0.0)) return;  // the URDF's own links contain the base
    throw std::runtime_error(
        fmt::format("robot {}: base.footprint.mass is missing; dynamic simulation of a mobile base needs a mass in kg",
                    model.name));
  }
  if (!(volume > 0.0))
    throw std::runtime_error(fmt::format(
        "robot {}: base.footprint is missing; dynamic simulation spreads the base's mass over its shape", model.name));
  for (const CollisionShape& shape : model.shapes) {
    if (shape.link != 0) continue;
    const Volume part = volume_of(shape.shape);
    const double m = mass * part.volume / volume;
    const Matrix3 R = shape.X_LS.linear();
    add(body, m, shape.X_LS.translation(), R * (m * part.inertia).asDiagonal() * R.transpose());
  }
}

void check(const RobotModel& model, const RigidBody& body) {
  const std::string& name = model.link(body.link).name;
  if (body.joint >= 0) {
    const ControlledJoint& joint = model.joint(body.joint);
    if (!(joint.effort > 0.0))
      throw std::runtime_error(fmt::format(
          "robot {}: joint '{}' has no effort limit; dynamic simulation needs one: give it as arm.limits.{}.effort",
          model.name, joint.name, joint.name));
  }
  if (body.joint < 0 && !(body.mass > 0.0))
    throw std::runtime_error(
        fmt::format("robot {}: base.footprint.mass is missing; dynamic simulation of a mobile base needs a mass in kg",
                    model.name));
  if (!(body.mass > 0.0) || !std::isfinite(body.mass))
    throw std::runtime_error(fmt::format(
        "robot {}: link '{}' and the links fixed to it have no mass; dynamic simulation needs <inertial> in the URDF",
        model.name, name));
  const Eigen::SelfAdjointEigenSolver<Matrix3> moments(body.I_C);
  const Vector3& m = moments.eigenvalues();
  if (!m.allFinite() || !(m.minCoeff() > 0.0))
    throw std::runtime_error(
        fmt::format("robot {}: the inertia of link '{}' and the links fixed to it is not positive definite (principal "
                    "moments {}, {}, {} kg m^2); dynamic simulation needs <inertia> in the URDF",
                    model.name, name, m.x(), m.y(), m.z()));
}

void add_payload(const RobotModel& model, const Payload& payload, RigidBodies& out) {
  const auto tip = static_cast<std::size_t>(model.tip);
  if (!(payload.mass > 0.0) || out.of_link[tip] < 0) return;
  constexpr double kDensity = 1000.0;  // [kg/m^3]
  const double radius = std::cbrt(payload.mass / (kDensity * 4.0 / 3.0 * std::numbers::pi));
  const Vector3 center = out.X_ML[tip] * model.X_TE * payload.p_EP_E;
  add(out.bodies[static_cast<std::size_t>(out.of_link[tip])], payload.mass, center,
      0.4 * payload.mass * radius * radius * Matrix3::Identity());
}

}  // namespace

RigidBodies rigid_bodies(const RobotModel& model, double base_mass, const Payload& payload) {
  RigidBodies out;
  const std::size_t links = model.links.size();
  out.of_link.assign(links, -1);
  out.X_ML.assign(links, Isometry::Identity());

  // Fixed and held joints keep links together, so that any configuration shows their relative poses.
  const Kinematics kinematics(std::make_shared<RobotModel>(model));
  for (std::size_t i = 0; i < links; ++i) {
    const Link& link = model.links[i];
    if (link.parent < 0) {
      if (!model.mobile()) continue;
      out.bodies.push_back({});
      add_base_mass(model, base_mass, out.bodies.back());
      out.of_link[i] = 0;
    } else if (link.controlled >= 0) {
      RigidBody body;
      body.link = static_cast<int>(i);
      body.parent = out.of_link[static_cast<std::size_t>(link.parent)];
      body.joint = link.controlled;
      out.of_link[i] = static_cast<int>(out.bodies.size());
      out.bodies.push_back(body);
    } else {
      out.of_link[i] = out.of_link[static_cast<std::size_t>(link.parent)];
    }
    if (out.of_link[i] < 0) continue;
    RigidBody& body = out.bodies[static_cast<std::size_t>(out.of_link[i])];
    out.X_ML[i] = kinematics.X_WL(body.link).inverse() * kinematics.X_WL(static_cast<int>(i));
    if (!link.inertial) continue;
    const Matrix3 R = out.X_ML[i].linear();
    add(body, link.inertial->mass, out.X_ML[i] * link.inertial->com_L, R * link.inertial->I_C * R.transpose());
  }
  for (const RigidBody& body : out.bodies) check(model, body);
  add_payload(model, payload, out);
  return out;
}

}  // namespace moma
