#include "world/plant/ode_support.h"

#include <algorithm>
#include <cmath>

#include "controller/model/analytic_distance.h"

namespace moma {

OdeSupport::OdeSupport(const OdeArm& arm, const std::vector<Vector2>& points, double radius, double cfm)
    : space_(ode::make_simple_space()), cfm_(cfm) {
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

void OdeSupport::add_contacts(dWorldID world, dJointGroupID group) {
  for (const dGeomID sphere : spheres_) {
    dContact contact{};
    if (dCollide(sphere, floor_, 1, &contact.geom, sizeof(dContactGeom)) == 0) continue;
    contact.surface.mode = dContactSoftCFM;
    contact.surface.soft_cfm = cfm_;
    contact.surface.mu = 0.0;
    dJointAttach(dJointCreateContact(world, group, &contact), dGeomGetBody(sphere), nullptr);
  }
}

namespace {

/// Half edges of the box around a shape, in the axes of the frame that R turns the shape into.
Vector3 half_edges(const Shape& shape, const Matrix3& R) {
  switch (shape.kind) {
    case ShapeKind::kBox: return R.cwiseAbs() * (0.5 * shape.size);
    case ShapeKind::kCylinder: return R.cwiseAbs() * Vector3(shape.size.x(), shape.size.x(), 0.5 * shape.size.y());
    case ShapeKind::kCapsule: return R.col(2).cwiseAbs() * (0.5 * shape.size.y()) + Vector3::Constant(shape.size.x());
    case ShapeKind::kSphere:
    case ShapeKind::kConvex: break;
  }
  return Vector3::Constant(bounding_radius(shape));
}

}  // namespace

std::vector<Vector2> OdeSupport::corners(const RobotModel& model, double radius, bool at_ends) {
  Eigen::AlignedBox2d box;
  for (const CollisionShape& shape : model.shapes) {
    if (shape.link != 0) continue;
    const Vector2 center = shape.X_LS.translation().head<2>();
    const Vector2 half = half_edges(shape.shape, shape.X_LS.linear()).head<2>();
    box.extend(center - half);
    box.extend(center + half);
  }
  const auto covered = [&](const Vector2& p) {
    return std::any_of(model.shapes.begin(), model.shapes.end(), [&](const CollisionShape& shape) {
      if (shape.link != 0) return false;
      const Vector3 at(p.x(), p.y(), shape.X_LS.translation().z());
      return point_distance(shape.shape, shape.X_LS.inverse() * at).d < -0.25 * radius;
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

}  // namespace moma
