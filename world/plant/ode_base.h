#pragma once

#include <ode/ode.h>

#include <memory>
#include <span>
#include <vector>

#include "controller/model/robot_model.h"
#include "world/plant/ode_arm.h"
#include "world/plant/ode_library.h"

namespace moma {

/// Depth of the base frame below the floor at the start and at rest [m]: half of the contact layer, so that wheels and
/// casters are in contact from the start without being pushed out.
inline constexpr double kContactLayer = 1e-4;
inline constexpr double kStartDrop = 0.5 * kContactLayer;

/// Drive and support of a mobile base. Each kind is a file, NAME_base.cc, and its name in world/CMakeLists.txt.
class OdeBase {
 public:
  virtual ~OdeBase() = default;
  /// Mass of the drive's own bodies [kg]; it is subtracted from the footprint's, if that has one.
  static double own_mass(const RobotModel& model);
  /// Creates the drive with the base at (x, y, phi); `friction` acts between floor and driven wheels. Null for a fixed
  /// base. Throws std::runtime_error naming the key if data is missing.
  static std::unique_ptr<OdeBase> make(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                       double friction);

  /// Sets the drive for one step of h seconds; `speeds` are the base's velocity coordinates after the ramp.
  virtual void command(const Eigen::Ref<const VectorX>& speeds, double h) = 0;
  /// Adds the contacts with the floor of a step of h seconds.
  virtual void add_floor_contacts(dWorldID world, dJointGroupID group, double h) = 0;
  /// The same as OdeArm::set_bounded(), for the drive's motors.
  virtual void set_bounded(bool bounded) = 0;
  virtual double load() const = 0;
  /// Largest slip since the last add_floor_contacts() [m/s], after the step.
  virtual double slip() const = 0;
  /// Sum of |torque x speed| of the drive's motors over the last step [W].
  virtual double power() const = 0;
  /// Adds the drive's own bodies to those that an undone step restores.
  virtual void list_bodies(ode::BodyStates& bodies) const = 0;
};

/// The drive of one kind of base: its two functions are those of OdeBase, null for a fixed base. NAME_base.cc defines
/// `OdeBaseKind NAME_base()`.
struct OdeBaseKind {
  std::unique_ptr<OdeBase> (*make)(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                   double friction) = nullptr;
  double (*own_mass)(const RobotModel& model) = nullptr;

  /// All kinds in the order of BaseType, which CMake makes from the list in world/CMakeLists.txt.
  static std::span<const OdeBaseKind> all();
};

/// Returns ODE's ERP, the share of a constraint's error that a step of h seconds removes: errors decay with a time
/// constant of 9 ms for any step (0.2 at 2 ms, 0.67 at 10 ms).
double error_reduction(double h);

/// Frictionless spheres that carry the base: casters of a differential drive, or the rolling contacts of mecanum
/// wheels, whose friction is in their drive.
class OdeSupport {
 public:
  /// @param points contact points on the floor, in B. @param stiffness of their contacts [N/m]. That of casters is 1e8:
  /// stiff, but much softer than the wheels, so that the wheels carry the weight and casters prevent tipping.
  OdeSupport(const OdeArm& arm, const std::vector<Vector2>& points, double radius, double stiffness);

  /// Adds the contacts for a step of h seconds.
  void add_contacts(dWorldID world, dJointGroupID group, double h);

  /// Returns four points under the base's outline, as far out as they fit. `at_ends` puts them at its front and rear
  /// and moves them inwards from the sides (beside the wheels of a differential drive); otherwise they move inwards
  /// along the diagonals.
  static std::vector<Vector2> corners(const RobotModel& model, double radius, bool at_ends);

 private:
  ode::Space space_;
  std::vector<dGeomID> spheres_;
  dGeomID floor_ = nullptr;
  double stiffness_;
};

}  // namespace moma
