#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/model/robot_model.h"
#include "controller/part_clock.h"
#include "world/world.h"

namespace moma {

/// A ball with the density of water, held at the end effector.
struct Payload {
  double mass = 0.0;                 ///< [kg]; 0: no payload
  Vector3 p_EP_E = Vector3::Zero();  ///< centre in the end effector's frame [m]
};

/// Differences between a trial's physics and those of the robot file and docs/explanation/physics.md. Dynamic mode
/// only.
struct PlantConditions {
  Payload payload;
  double floor_friction = 1.0;  ///< between floor and driven wheels [1]
  VectorX joint_friction;       ///< dry friction of each controlled joint [Nm or N]; empty: none
};

enum class PlantPart {
  kRest,     ///< setting motors, reading states, integrating motion
  kCollide,  ///< contacts, and the continuous check between steps
  kStep,     ///< the physics engine's step
};

using PlantClock = PartClock<PlantPart>;

enum class SimulationMode { kKinematic, kDynamic };
constexpr auto words(Of<SimulationMode>) { return std::to_array<std::string_view>({"kinematic", "dynamic"}); }

/// Effect of a joint beyond its limit in kinematic mode: the trial ends, the joint stops there, or it moves on.
enum class AtJointLimit { kEnd, kClamp, kIgnore };
constexpr auto words(Of<AtJointLimit>) { return std::to_array<std::string_view>({"end", "clamp", "ignore"}); }

struct SimulationConfig {
  SimulationMode mode = SimulationMode::kDynamic;
  double control_period = 0.02;  ///< [s]
  double physics_step = 0.01;    ///< [s]
  double time_limit = 30.0;      ///< [s]
  double cross_check = 0.02;     ///< [1]
  AtJointLimit joint_limits = AtJointLimit::kEnd;
};

constexpr void describe(auto& v, Of<SimulationConfig>) {
  using T = SimulationConfig;
  v.member("mode", &T::mode, {.text = "kinematic: the command is the velocity; dynamic: ODE"});
  v.member("control_period", &T::control_period,
           in_range({1e-4, 1.0}, "s", "time between two steps of the controller"));
  v.member(
      "physics_step", &T::physics_step,
      in_range({1e-5, 0.02}, "s", "longest step of ODE; steps are equal, and divided further if a pair may touch"));
  v.member("time_limit", &T::time_limit, in_range({0.0, 3600.0, true, false}, "s", "longest time of a trial"));
  v.member("cross_check", &T::cross_check,
           in_range({0.0, 1.0}, "1", "share of the control steps in which the two contact detectors are compared"));
  v.member(
      "joint_limits", &T::joint_limits,
      {.written = Written::kUnlessDefault,
       .text =
           "effect of a joint beyond its limit in kinematic mode: the trial ends, the joint stops there or moves on"});
}

struct PlantState {
  Vector3 base = Vector3::Zero();  ///< (x, y, phi), phi continuous (not wrapped)
  VectorX q;
  VectorX qdot;  ///< num_velocities(); kinematic mode: the previous command
};

/// A contact that ends a trial: a robot shape against an object (second = its index), the floor (-1), or another robot
/// shape (second = its index).
struct Contact {
  PairKind kind = PairKind::kObject;
  int first = 0;
  int second = 0;
  double depth = 0.0;  ///< >= 0 [m]
  double time = 0.0;   ///< [s] since the start
  bool by_ode = true;  ///< false: the distance library decided (cylinders, hulls)
};

struct PlantReport {
  std::vector<Contact>
      contacts;  ///< colliding pairs, each once with its first time and greatest depth, in order of time, then indices
  bool diverged = false;  ///< state not finite, too fast, or physics failed
  std::string reason;     ///< description if diverged or tipped
  bool tipped = false;    ///< base axis more than 30 degrees off vertical, or base below the floor
  double slip_max = 0.0;  ///< wheel contact slip speed [m/s]; dynamic mode
  double energy = 0.0;    ///< integral of |torque x speed| [J]; dynamic mode
  int lcp_messages = 0;
  int redone_steps = 0;   ///< physics steps repeated with the motors' limits; dynamic mode
  int divided_steps = 0;  ///< physics steps divided because of possible contacts; dynamic mode

  /// Keeps the capacity of the contacts.
  void clear() {
    std::vector<Contact> kept = std::move(contacts);
    kept.clear();
    *this = PlantReport();
    contacts = std::move(kept);
  }
};

/// Agreement of ODE's contacts with the distance library in one state (contacts.h).
struct DetectorCheck {
  int disagreements = 0;  ///< pairs that touch according to only one of them
  double deepest = 0.0;   ///< largest contradiction: depth or gap [m]
};

/// Interface between a trial and the simulated robot in its world.
class Plant {
 public:
  virtual ~Plant() = default;
  const PlantState& state() const noexcept { return state_; }
  /// Time since the start [s].
  double time() const noexcept { return time_; }
  /// Contacts of the start configuration, at t = 0.
  virtual void check_start(PlantReport& report) = 0;
  /// Holds `command` (num_velocities(), finite) for `duration` seconds. Overwrites `report`.
  virtual void advance(const VectorX& command, double duration, PlantReport& report) = 0;
  /// Takes an object of the world into the hand, as given, or notes that it has left its support; without a value,
  /// leaves it where it is. It weighs nothing. Throws std::runtime_error if the plant carries no objects.
  virtual void carry(const std::optional<Carried>& carried);
  /// Paces of the world's objects from now on; they stay where they are. Without a call each motion has the trial's
  /// time.
  virtual void set_paces(std::span<const Pace>) {}
  /// Compares the two contact detectors in the present state, without changing it.
  virtual DetectorCheck cross_check() { return {}; }
  /// Notifies `clock`, which must outlive the plant, at the parts of advance(); null by default.
  void set_clock(PlantClock* clock) noexcept { clock_ = clock; }

 protected:
  /// At rest at the world's start.
  Plant(const RobotModel& model, const World& world)
      : state_{world.start.base, world.start.q, VectorX::Zero(model.num_velocities())} {}

  PlantState state_;
  double time_ = 0.0;
  PlantClock* clock_ = nullptr;
};

/// Kinematic: exact integration, contacts at least every 5 ms of motion by ODE's collision detection. Dynamic: rigid
/// bodies, motors, wheels on the floor in ODE. Throws std::runtime_error (with link and key) if the robot lacks data
/// for dynamics (inertia, effort, wheels). The kinematic plant ignores `conditions`.
std::unique_ptr<Plant> make_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                  const SimulationConfig& simulation, const PlantConditions& conditions = {});

/// Returns the robot `empty` with the object in its hand as a last shape; without one, `empty`. An object that `now`
/// carries and the result does not is put down: `world` gets its pose, with E at X_WE.
std::shared_ptr<const RobotModel> with_carried(const std::shared_ptr<const RobotModel>& empty, const RobotModel& now,
                                               const Isometry& X_WE, const std::optional<Carried>& carried,
                                               World& world);

/// Throws std::invalid_argument naming the coordinate where the command has a wrong size or is not finite: such a
/// number must never reach the physics.
void check_command(const RobotModel& model, const VectorX& command, double duration);

/// States that are checked for contact: those that GapWatch (gap_watch.h) does not show to be clear, or all. Both find
/// the same contacts.
enum class ContactChecks { kWhereSomethingMayTouch, kAll };

/// The command is the velocity: joints move by q + command t, the base along its exact arc. Contacts are checked at
/// least every 5 ms of motion. With `stops` a joint stops at its limit.
std::unique_ptr<Plant> make_kinematic_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                            bool stops = false,
                                            ContactChecks checks = ContactChecks::kWhereSomethingMayTouch);

/// Use of the motors' limits in ODE's solver. A step without them is a quarter cheaper; if a motor exceeds its limit,
/// the step is undone and repeated with all limits.
enum class MotorBounds { kWhereTheyBind, kAlways };

/// Rigid bodies, joint motors with effort limits, wheels on the floor (docs/explanation/physics.md).
std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                      const SimulationConfig& simulation, const PlantConditions& conditions,
                                      MotorBounds bounds = MotorBounds::kWhereTheyBind);

}  // namespace moma
