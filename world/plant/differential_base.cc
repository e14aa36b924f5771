#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "world/plant/ode_base.h"

namespace moma {
namespace {

constexpr double kCasterStiffness = 1e8;  // [N/m]

// Both wheels: 2 % of the base's mass each, at most 1 kg. Light compared with the base, but not light enough to be
// numerically stiff.
double mass_of_wheels(const RobotModel& model) {
  double base_mass = model.base.mass;
  if (!(base_mass > 0.0)) {  // then the links that are rigid with the base carry it
    for (std::size_t i = 1; i < model.links.size(); ++i)
      if (model.links[i].inertial && model.rigid_root(static_cast<int>(i)) == 0)
        base_mass += model.links[i].inertial->mass;
  }
  return 2.0 * std::min(1.0, 0.02 * base_mass);
}

/// Two driven wheels (spheres: a cylinder would scrub as it turns on the spot), four casters at the corners.
class DifferentialBase final : public OdeBase {
 public:
  DifferentialBase(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base, double friction)
      : friction_(friction),
        wheels_(*model.base.wheels),
        base_(arm.body_of_link(0)),
        space_(ode::make_simple_space()),
        support_(arm, OdeSupport::corners(model, 0.5 * wheels_.radius, true), 0.5 * wheels_.radius, kCasterStiffness) {
    floor_ = dCreatePlane(space_.get(), 0.0, 0.0, 1.0, 0.0);
    const double mass = 0.5 * mass_of_wheels(model);
    // Enough to make the wheels slip under the whole weight, so that friction limits the drive.
    torque_ = friction_ * arm.mass() * 9.81 * wheels_.radius;
    const Isometry X_WB = base_pose(base);
    for (std::size_t i = 0; i < 2; ++i) {
      Wheel& wheel = wheel_[i];
      wheel.side = i == 0 ? 0.5 * wheels_.separation : -0.5 * wheels_.separation;
      Vector3 center = X_WB * Vector3(0.0, wheel.side, wheels_.radius);
      center.z() -= kStartDrop;
      wheel.body = dBodyCreate(world);
      dMass inertia;
      dMassSetSphereTotal(&inertia, mass, wheels_.radius);
      dBodySetMass(wheel.body, &inertia);
      dBodySetFiniteRotationMode(wheel.body, 1);
      dBodySetPosition(wheel.body, center.x(), center.y(), center.z());
      wheel.geom = dCreateSphere(space_.get(), wheels_.radius);
      dGeomSetBody(wheel.geom, wheel.body);
      wheel.hinge = dJointCreateHinge(world, nullptr);
      dJointAttach(wheel.hinge, wheel.body, base_);
      dJointSetHingeAnchor(wheel.hinge, center.x(), center.y(), center.z());
      const Vector3 axle = X_WB.linear() * Vector3::UnitY();
      dJointSetHingeAxis(wheel.hinge, axle.x(), axle.y(), axle.z());
      dJointSetHingeParam(wheel.hinge, dParamFMax, torque_);
      dJointSetFeedback(wheel.hinge, &wheel.feedback);
    }
  }

  void command(const Eigen::Ref<const VectorX>& speeds, double) override {
    for (Wheel& wheel : wheel_) {
      dVector3 axle;
      dJointGetHingeAxis(wheel.hinge, axle);
      wheel.axle = ode::from_vector(axle);
      // Inverse of v = R/2 (w_L + w_R), omega = R/W (w_R - w_L).
      const double rolling = speeds[0] - speeds[1] * wheel.side;
      const double spin = std::clamp(rolling / wheels_.radius, -wheels_.max_speed, wheels_.max_speed);
      dJointSetHingeParam(wheel.hinge, dParamVel, spin);
    }
  }

  void add_floor_contacts(dWorldID world, dJointGroupID group, double h) override {
    const Vector3 forward = ode::from_matrix(dBodyGetRotation(base_)).col(0);
    for (Wheel& wheel : wheel_) {
      dContact contact{};
      wheel.touches = dCollide(wheel.geom, floor_, 1, &contact.geom, sizeof(dContactGeom)) > 0;
      if (!wheel.touches) continue;
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = friction_;
      const double level = std::hypot(forward.x(), forward.y());
      if (level > 0.1) {  // not if the base has tipped onto its side
        contact.surface.mode |= dContactFDir1;
        contact.fdir1[0] = forward.x() / level;
        contact.fdir1[1] = forward.y() / level;
      }
      dJointAttach(dJointCreateContact(world, group, &contact), wheel.body, nullptr);
    }
    support_.add_contacts(world, group, h);
  }

  double slip() const override {
    double most = 0.0;
    for (const Wheel& wheel : wheel_) {
      if (!wheel.touches) continue;
      const Vector3 v = ode::from_vector(dBodyGetLinearVel(wheel.body)) +
                        ode::from_vector(dBodyGetAngularVel(wheel.body)).cross(Vector3(0.0, 0.0, -wheels_.radius));
      most = std::max(most, std::hypot(v.x(), v.y()));
    }
    return most;
  }

  double power() const override {
    double sum = 0.0;
    for (const Wheel& wheel : wheel_) sum += std::abs(wheel.driving_torque() * dJointGetHingeAngleRate(wheel.hinge));
    return sum;
  }

  void set_bounded(bool bounded) override {
    for (const Wheel& wheel : wheel_) dJointSetHingeParam(wheel.hinge, dParamFMax, bounded ? torque_ : dInfinity);
  }

  double load() const override {
    double most = 0.0;
    for (const Wheel& wheel : wheel_) most = larger_load(most, wheel.driving_torque(), torque_);
    return most;
  }

  void list_bodies(ode::BodyStates& bodies) const override {
    for (const Wheel& wheel : wheel_) bodies.add(wheel.body);
  }

 private:
  struct Wheel {
    dBodyID body = nullptr;
    dGeomID geom = nullptr;
    dJointID hinge = nullptr;
    dJointFeedback feedback{};
    double side = 0.0;                // y in B
    Vector3 axle = Vector3::UnitY();  // in the world, at the start of the step
    bool touches = false;

    // The anchor is the wheel's centre: no lever arm.
    double driving_torque() const { return ode::from_vector(feedback.t1).dot(axle); }
  };

  double friction_;
  double torque_ = 0.0;  // largest torque of a motor [Nm]
  Wheels wheels_;
  dBodyID base_;
  ode::Space space_;
  dGeomID floor_ = nullptr;
  OdeSupport support_;
  std::array<Wheel, 2> wheel_;
};

std::unique_ptr<OdeBase> make_differential(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                           double friction) {
  if (!model.base.wheels)
    throw std::runtime_error(fmt::format(
        "robot {}: base.wheels is missing; dynamic simulation of a differential base drives its wheels", model.name));
  return std::make_unique<DifferentialBase>(world, model, arm, base, friction);
}

}  // namespace

OdeBaseKind differential_base() { return {make_differential, mass_of_wheels}; }

}  // namespace moma
