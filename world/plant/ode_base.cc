#include "world/plant/ode_base.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "controller/model/proximity.h"

namespace moma {
namespace {

/// A solid of the base with its pose in B and its bounding box.
struct Part {
  Shape shape;
  Isometry X_BS;
  Eigen::AlignedBox3d box;
};

Eigen::AlignedBox3d box_around(const Shape& shape, const Isometry& X) {
  const Matrix3 R = X.linear();
  const Vector3 p = X.translation();
  if (shape.kind == ShapeKind::kConvex) {
    Eigen::AlignedBox3d box;
    for (const Vector3& v : shape.hull->vertices) box.extend(X * v);
    return box;
  }
  Vector3 half = Vector3::Constant(shape.size.x());
  if (shape.kind == ShapeKind::kBox) half = R.cwiseAbs() * (0.5 * shape.size);
  if (shape.kind == ShapeKind::kCylinder)
    half = R.cwiseAbs() * Vector3(shape.size.x(), shape.size.x(), 0.5 * shape.size.y());
  if (shape.kind == ShapeKind::kCapsule) half += R.col(2).cwiseAbs() * (0.5 * shape.size.y());
  return {p - half, p + half};
}

/// Returns shapes that are rigid with the base and near the floor, without columns or mounts above.
std::vector<Part> base_parts(const RobotModel& model) {
  constexpr double kLow = 0.25;  // [m]
  const Kinematics kinematics(std::make_shared<RobotModel>(model));
  std::vector<Part> parts;
  for (const CollisionShape& shape : model.shapes) {
    if (!shape.rigid_with_base) continue;
    const Isometry X_BS = kinematics.X_WB().inverse() * kinematics.X_WS(shape);
    const Eigen::AlignedBox3d box = box_around(shape.shape, X_BS);
    if (box.min().z() < kLow) parts.push_back({shape.shape, X_BS, box});
  }
  return parts;
}

}  // namespace

double error_reduction(double h) {
  constexpr double kFade = 0.00896;  // [s]
  return -std::expm1(-h / kFade);
}

OdeSupport::OdeSupport(const OdeArm& arm, const std::vector<Vector2>& points, double radius, double stiffness)
    : space_(ode::make_simple_space()), stiffness_(stiffness) {
  floor_ = dCreatePlane(space_.get(), 0.0, 0.0, 1.0, 0.0);
  for (const Vector2& p : points) {
    const dGeomID sphere = dCreateSphere(space_.get(), radius);
    dGeomSetBody(sphere, arm.body_of_link(0));
    Isometry X = Isometry::Identity();
    X.translation() = Vector3(p.x(), p.y(), radius);
    ode::set_offset(sphere, arm.in_body(0, X));
    spheres_.push_back(sphere);
  }
}

void OdeSupport::add_contacts(dWorldID world, dJointGroupID group, double h) {
  const double cfm = error_reduction(h) / (stiffness_ * h);
  for (const dGeomID sphere : spheres_) {
    dContact contact{};
    if (dCollide(sphere, floor_, 1, &contact.geom, sizeof(dContactGeom)) == 0) continue;
    contact.surface.mode = dContactSoftCFM;
    contact.surface.soft_cfm = cfm;
    contact.surface.mu = 0.0;
    dJointAttach(dJointCreateContact(world, group, &contact), dGeomGetBody(sphere), nullptr);
  }
}

std::vector<Vector2> OdeSupport::corners(const RobotModel& model, double radius, bool at_ends) {
  const std::vector<Part> parts = base_parts(model);
  if (parts.empty())
    throw std::runtime_error(fmt::format(
        "robot {}: base.footprint is missing; dynamic simulation puts casters under the base's outline", model.name));
  Eigen::AlignedBox2d box;
  for (const Part& part : parts) {
    box.extend(Vector2(part.box.min().head<2>()));
    box.extend(Vector2(part.box.max().head<2>()));
  }
  const Shape probe{ShapeKind::kSphere, Vector3(0.25 * radius, 0.0, 0.0), nullptr};
  const auto covered = [&](const Vector2& p) {
    return std::ranges::any_of(parts, [&](const Part& part) {
      Isometry X = Isometry::Identity();
      X.translation() = Vector3(p.x(), p.y(), part.box.center().z());
      // Wholly inside: deeper than the probe's own diameter.
      return shape_distance(probe, X, part.shape, part.X_BS).d < -0.5 * radius;
    });
  };
  const Vector2 half = (0.5 * box.sizes() - Vector2::Constant(radius)).cwiseMax(0.5 * radius);
  std::vector<Vector2> points;
  for (const double side : {1.0, -1.0}) {
    for (const double front : {1.0, -1.0}) {
      const auto at = [&](double scale) -> Vector2 {
        return box.center() + Vector2(front * half.x() * (at_ends ? 1.0 : scale), side * half.y() * scale);
      };
      double scale = 1.0;
      while (scale > 0.1 && !covered(at(scale))) scale -= 0.025;
      points.push_back(at(scale));
    }
  }
  return points;
}

double OdeBase::own_mass(const RobotModel& model) {
  const auto own_mass = OdeBaseKind::all()[static_cast<std::size_t>(model.base.type)].own_mass;
  return own_mass != nullptr ? own_mass(model) : 0.0;
}

std::unique_ptr<OdeBase> OdeBase::make(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                       double friction) {
  const auto make = OdeBaseKind::all()[static_cast<std::size_t>(model.base.type)].make;
  return make != nullptr ? make(world, model, arm, base, friction) : nullptr;
}

}  // namespace moma
