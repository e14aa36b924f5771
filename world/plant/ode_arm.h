#pragma once

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "world/plant/ode_library.h"
#include "world/plant/rigid_bodies.h"

namespace moma {

/// Returns the larger of `most` and |effort| / limit, the load of a motor; infinite if it is not finite.
inline double larger_load(double most, double effort, double limit) {
  const double load = std::abs(effort) / limit;
  return std::isfinite(load) ? std::max(most, load) : std::numeric_limits<double>::infinity();
}

/// The robot's links as ODE bodies, its controlled joints as hinges and sliders with velocity motors.
class OdeArm {
 public:
  /// Places every body at the start configuration, `drop` metres lower (so that wheels begin in contact).
  OdeArm(dWorldID world, std::shared_ptr<const RobotModel> model, const Vector3& base, const VectorX& q, double drop,
         double base_mass, const PlantConditions& conditions);
  OdeArm(const OdeArm&) = delete;
  OdeArm& operator=(const OdeArm&) = delete;

  int num_bodies() const { return static_cast<int>(bodies_.size()); }
  dBodyID body(int i) const { return bodies_[static_cast<std::size_t>(i)]; }
  /// Null if the link is fixed to the world.
  dBodyID body_of_link(int link) const;
  /// Converts a pose in a link's frame to its body's frame (at the centre of mass).
  Isometry in_body(int link, const Isometry& X_L) const;
  double mass() const { return mass_; }
  const RigidBodies& rigid() const { return rigid_; }

  /// Sets the motors for one step of h seconds: within velocity limits, and decelerating ahead of the joint limits, so
  /// that ODE's stops are a last resort.
  void command(const Eigen::Ref<const VectorX>& speeds, double h);
  /// Selects whether the motors' efforts bound the next step's solution. An unbounded step is cheaper, and has the same
  /// result if load() is below 1 afterwards. It requires that none of ODE's stops acts: clear_of_stops().
  void set_bounded(bool bounded);
  bool clear_of_stops() const;
  /// Stores the axes to which the next step's torques refer.
  void before_step();
  /// Reads the motors' torques and forces from ODE's feedback.
  void after_step();
  /// Greatest |torque| / effort of a motor in the last step; infinite if one is not finite.
  double load() const;
  /// Sum of |torque x speed| of the motors over the last step [W].
  double power() const;

  /// Reads present joint positions (not wrapped) and rates.
  void read(VectorX& q, Eigen::Ref<VectorX> qdot);
  /// State of read(), for undoing a step: angles count full turns.
  const VectorX& q() const { return q_; }
  void set_q(const VectorX& q) { q_ = q; }

 private:
  struct Joint {
    dJointID id = nullptr;
    bool slides = false;
    double zero = 0.0;  // joint value at which ODE's own coordinate is zero
    double effort = 0.0;
    dJointFeedback feedback{};
    Vector3 axis = Vector3::UnitZ();  // in the world, at the start of the step
    Vector3 lever = Vector3::Zero();  // from the child's centre to the anchor, at the start of the step
    double torque = 0.0;              // torque or force, about or along the axis
  };
  /// Sets a parameter of the joint, with ODE's name of it for either kind.
  static void set_param(const Joint& joint, int parameter, double value);
  void make_joint(dWorldID world, const RigidBody& body, const Kinematics& kinematics);
  static void add_friction(dWorldID world, const Joint& joint, double most);
  void place(const Kinematics& kinematics, double drop);

  std::shared_ptr<const RobotModel> model_;
  RigidBodies rigid_;
  std::vector<dBodyID> bodies_;
  std::vector<Joint> joints_;  // never resized after construction: ODE points into it
  VectorX q_;
  double mass_ = 0.0;
  bool bounded_ = true;
};

}  // namespace moma
