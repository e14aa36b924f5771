#include "world/plant/ode_plant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/model/base_kind.h"
#include "world/plant/command_check.h"
#include "world/plant/contacts.h"
#include "world/plant/ode_arm.h"
#include "world/plant/ode_base.h"

namespace moma {
namespace {

constexpr double kGravity = 9.81;   // [m/s^2]
constexpr double kTopSpeed = 20.0;  // of any body; beyond it the physics has lost its footing [m/s]
constexpr double kTipAngle = 30.0;  // [degrees]
constexpr double kFallen = -0.1;    // height of the base frame [m]
constexpr double kObjectFriction = 0.5;

class OdePlant final : public Plant, private TouchSink {
 public:
  OdePlant(std::shared_ptr<const RobotModel> model, const World& world, const SimulationConfig& simulation,
           const PlantConditions& conditions)
      : model_(std::move(model)),
        step_(simulation.physics_step),
        scene_(model_, world, true),
        kinematics_(model_),
        contacts_(dJointGroupCreate(0)),
        arm_(world_.id(), model_, world.start.base, world.start.q, drop(*model_), mass_without_wheels(*model_),
             conditions),
        base_(OdeBase::make(world_.id(), *model_, arm_, world.start.base, conditions.floor_friction)) {
    const dWorldID id = world_.id();
    dWorldSetGravity(id, 0.0, 0.0, -kGravity);
    dWorldSetCFM(id, 1e-9);
    dWorldSetERP(id, 0.2);
    dWorldSetContactMaxCorrectingVel(id, 0.1);
    dWorldSetContactSurfaceLayer(id, kContactLayer);
    attach_shapes(world);
    state_.base = world.start.base;
    state_.q = world.start.q;
    state_.qdot = VectorX::Zero(model_->num_velocities());
    ramped_ = VectorX::Zero(model_->base_dof());
    scene_.place_objects(0.0);
    push_objects();
  }

  ~OdePlant() override {
    if (!world_.abandoned()) return;
    // The world's memory is left alone, so what points into it must not be freed either.
    (void)contacts_.release();
  }

  const PlantState& state() const override { return state_; }
  double time() const override { return time_; }
  DetectorCheck cross_check() override { return scene_.cross_check(); }

  void check_start(PlantReport& report) override {
    clear(report);
    detect(time_, report);
  }

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    check_command(*model_, command, duration);
    clear(report);
    if (!failure_.empty()) {
      report.diverged = true;
      report.reason = failure_;
      return;
    }
    ode::use_on_this_thread();
    ode::take_lcp_messages();
    const int steps = std::max(1, static_cast<int>(std::lround(duration / step_)));
    const double h = duration / steps;
    PlantReport ignored;
    if (!detected_) detect(time_, ignored);
    for (int i = 1; i <= steps; ++i) {
      if (!step(command, h, report)) break;
      detect(i == steps ? time_ + duration : time_ + i * h, report);
    }
    time_ += duration;
    report.lcp_messages = ode::take_lcp_messages();
    check_upright(report);
  }

 private:
  static double drop(const RobotModel& model) { return model.base_dof() > 0 ? kStartDrop : 0.0; }
  static double mass_without_wheels(const RobotModel& model) {
    return std::max(0.0, model.base.mass - OdeBase::own_mass(model));
  }

  static void clear(PlantReport& report) {
    std::vector<Contact> contacts = std::move(report.contacts);
    contacts.clear();
    report = PlantReport();
    report.contacts = std::move(contacts);
  }

  void attach_shapes(const World& world) {
    kinematics_.update(world.start.base, world.start.q);
    scene_.place_robot(kinematics_);  // for those of a fixed base, which have no body
    for (int i = 0; i < static_cast<int>(model_->shapes.size()); ++i) {
      const CollisionShape& shape = model_->shapes[static_cast<std::size_t>(i)];
      const dGeomID geom = scene_.robot_geom(i);
      const dBodyID body = arm_.body_of_link(shape.link);
      if (geom == nullptr || body == nullptr) continue;
      dGeomSetBody(geom, body);
      ode::set_offset(geom, arm_.in_body(shape.link, shape.X_LS * scene_.robot_tilt(i)));
    }
    // Moving objects are kinematic bodies, so that a contact knows their velocity.
    object_bodies_.assign(world.objects.size(), nullptr);
    for (std::size_t i = 0; i < world.objects.size(); ++i) {
      const dGeomID geom = scene_.object_geom(static_cast<int>(i));
      if (geom == nullptr || at_rest(world.objects[i].motion, 0.0)) continue;
      object_bodies_[i] = dBodyCreate(world_.id());
      dBodySetKinematic(object_bodies_[i]);
      dBodySetPosition(object_bodies_[i], dGeomGetPosition(geom)[0], dGeomGetPosition(geom)[1],
                       dGeomGetPosition(geom)[2]);
      dBodySetRotation(object_bodies_[i], dGeomGetRotation(geom));
      dGeomSetBody(geom, object_bodies_[i]);
    }
  }

  void push_objects() {
    for (std::size_t i = 0; i < object_bodies_.size(); ++i) {
      if (object_bodies_[i] == nullptr) continue;
      const Vector6& V = scene_.object_states()[i].V_WO_W;
      dBodySetAngularVel(object_bodies_[i], V[0], V[1], V[2]);
      dBodySetLinearVel(object_bodies_[i], V[3], V[4], V[5]);
    }
  }

  /// The base's command follows the wanted one no faster than its acceleration limits.
  void ramp(const VectorX& command, double h) {
    const Vector2& limit = model_->base.max_acceleration;
    const int dof = model_->base_dof();
    if (dof == 0) return;
    const auto linear = ramped_.head(dof - 1);
    const VectorX wanted = command.head(dof - 1) - linear;
    const double change = wanted.norm();
    const double most = limit.x() * h;
    ramped_.head(dof - 1) += change > most ? VectorX(wanted * (most / change)) : wanted;
    ramped_[dof - 1] += std::clamp(command[dof - 1] - ramped_[dof - 1], -limit.y() * h, limit.y() * h);
  }

  /// One physics step. False where physics has failed; the report says why.
  bool step(const VectorX& command, double h, PlantReport& report) {
    ramp(command, h);
    if (base_) {
      base_->command(ramped_, h);
      base_->add_floor_contacts(world_.id(), contacts_.get());
    }
    arm_.command(command.tail(model_->num_joints()), h);
    try {
      if (dWorldStep(world_.id(), h) == 0) return fail(report, "ODE's step gave up");
    } catch (const ode::Fault& fault) {
      world_.abandon();
      return fail(report, fault.what());
    }
    dJointGroupEmpty(contacts_.get());
    if (!read_state()) return fail(report, "a body's state is not finite, or faster than 20 m/s");
    if (base_) {
      report.slip_max = std::max(report.slip_max, base_->slip());
      report.energy += base_->power() * h;
    }
    report.energy += arm_.power() * h;
    return true;
  }

  bool fail(PlantReport& report, const std::string& reason) {
    failure_ = fmt::format("diverged: {}", reason);
    report.diverged = true;
    report.reason = failure_;
    return false;
  }

  bool read_state() {
    for (int i = 0; i < arm_.num_bodies(); ++i) {
      const Vector3 v = ode::from_vector(dBodyGetLinearVel(arm_.body(i)));
      const Vector3 w = ode::from_vector(dBodyGetAngularVel(arm_.body(i)));
      if (!v.allFinite() || !w.allFinite() || !(v.norm() <= kTopSpeed) ||
          !ode::from_vector(dBodyGetPosition(arm_.body(i))).allFinite())
        return false;
    }
    if (base_ && !base_->healthy(kTopSpeed)) return false;
    const int dof = model_->base_dof();
    arm_.read(state_.q, state_.qdot.tail(model_->num_joints()));
    if (dof > 0) read_base();
    return state_.q.allFinite() && state_.qdot.allFinite() && state_.base.allFinite();
  }

  void read_base() {
    const dBodyID body = arm_.body(0);
    const Isometry X_WB = ode::pose(body) * arm_.in_body(0, Isometry::Identity());
    const Vector3 forward = X_WB.linear().col(0);
    const double heading = std::atan2(forward.y(), forward.x());
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const double phi = heading + kTurn * std::round((state_.base.z() - heading) / kTurn);
    state_.base = {X_WB.translation().x(), X_WB.translation().y(), phi};
    height_ = X_WB.translation().z();
    up_ = X_WB.linear()(2, 2);

    const Vector3 w = ode::from_vector(dBodyGetAngularVel(body));
    const Vector3 v = ode::from_vector(dBodyGetLinearVel(body)) +
                      w.cross(X_WB.translation() - ode::from_vector(dBodyGetPosition(body)));
    const double c = std::cos(phi), s = std::sin(phi);
    kind_of(model_->base.type).set_coordinates({c * v.x() + s * v.y(), c * v.y() - s * v.x(), w.z()}, state_.qdot);
  }

  void check_upright(PlantReport& report) const {
    if (!base_ || report.diverged) return;
    if (up_ < std::cos(kTipAngle * std::numbers::pi / 180.0)) {
      report.tipped = true;
      report.reason = fmt::format("the base leans by more than {} degrees", kTipAngle);
    } else if (height_ < kFallen) {
      report.tipped = true;
      report.reason = "the base has fallen below the floor";
    }
  }

  /// Contacts of the state as it is: reported, and made into contact joints for the next step.
  void detect(double time, PlantReport& report) {
    scene_.place_objects(time);
    push_objects();
    ContactLog log(report.contacts);
    log_ = &log;
    now_ = time;
    dJointGroupEmpty(contacts_.get());
    scene_.detect(*this);
    if (scene_.has_exact()) {
      kinematics_.update(state_.base, state_.q);
      scene_.detect_exact(kinematics_, time, log);
    }
    log.sort();
    log_ = nullptr;
    detected_ = true;
  }

  void touch(const Touch& touch) override {
    double depth = 0.0;
    for (int i = 0; i < touch.count; ++i) depth = std::max(depth, static_cast<double>(touch.points[i].depth));
    log_->add({touch.kind, touch.first, touch.second, depth, now_, true});
    for (int i = 0; i < touch.count; ++i) {
      const dBodyID a = dGeomGetBody(touch.points[i].g1);
      const dBodyID b = dGeomGetBody(touch.points[i].g2);
      if (a == b) continue;
      dContact contact{};
      contact.geom = touch.points[i];
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = kObjectFriction;
      dJointAttach(dJointCreateContact(world_.id(), contacts_.get(), &contact), a, b);
    }
  }

  // Destroyed last to first: joints and geoms before the world, whose bodies they point to.
  std::shared_ptr<const RobotModel> model_;
  double step_;
  ode::World world_;
  ContactScene scene_;
  Kinematics kinematics_;
  ode::JointGroup contacts_;
  OdeArm arm_;
  std::unique_ptr<OdeBase> base_;
  std::vector<dBodyID> object_bodies_;

  PlantState state_;
  VectorX ramped_;
  double time_ = 0.0;
  double height_ = 0.0;
  double up_ = 1.0;
  bool detected_ = false;
  std::string failure_;
  ContactLog* log_ = nullptr;
  double now_ = 0.0;
};

}  // namespace

std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                      const SimulationConfig& simulation, const PlantConditions& conditions) {
  return std::make_unique<OdePlant>(std::move(model), world, simulation, conditions);
}

}  // namespace moma
