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

std::vector<Vector2> OdeSupport::corners(const RobotModel& model, double radius) {
  Eigen::AlignedBox2d box;
  for (const CollisionShape& shape : model.shapes) {
    if (shape.link != 0) continue;
    Vector3 half = Vector3::Constant(bounding_radius(shape.shape));
    if (shape.shape.kind == ShapeKind::kBox) half = shape.X_LS.linear().cwiseAbs() * (0.5 * shape.shape.size);
    if (shape.shape.kind == ShapeKind::kCylinder) {
      const Vector3 bar(shape.shape.size.x(), shape.shape.size.x(), 0.5 * shape.shape.size.y());
      half = shape.X_LS.linear().cwiseAbs() * bar;
    }
    const Vector2 center = shape.X_LS.translation().head<2>();
    box.extend(center - half.head<2>());
    box.extend(center + half.head<2>());
  }
  const auto covered = [&](const Vector2& p) {
    return std::any_of(model.shapes.begin(), model.shapes.end(), [&](const CollisionShape& shape) {
      if (shape.link != 0) return false;
      const Vector3 at(p.x(), p.y(), shape.X_LS.translation().z());
      return point_distance(shape.shape, shape.X_LS.inverse() * at).d < -0.5 * radius;
    });
  };
  std::vector<Vector2> points;
  for (const double side : {1.0, -1.0}) {
    for (const double front : {1.0, -1.0}) {
      const Vector2 corner = 0.5 * Vector2(front * box.sizes().x(), side * box.sizes().y());
      double scale = 1.0;
      while (scale > 0.35 && !covered(box.center() + scale * corner)) scale -= 0.025;
      points.push_back(box.center() + scale * corner);
    }
  }
  return points;
}

}  // namespace moma
