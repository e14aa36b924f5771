#include "world/plant/plant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "controller/model/base_kind.h"
#include "world/plant/contacts.h"
#include "world/plant/gap_watch.h"
#include "world/plant/ode_arm.h"
#include "world/plant/ode_base.h"
#include "world/plant/ode_library.h"

namespace moma {
namespace {

constexpr double kGravity = 9.81;   // [m/s^2]
constexpr double kTopSpeed = 20.0;  // of any body; a higher one means that the physics diverged [m/s]
constexpr double kTipAngle = 30.0;  // [degrees]
constexpr double kFallen = -0.1;    // height of the base frame [m]
constexpr double kObjectFriction = 0.5;
constexpr double kContactStep = 0.001;  // longest step if a pair may touch [s]
constexpr double kNearlyBound = 0.99;   // share of a motor's limit from which the next step is bounded at once

class OdePlant final : public Plant {
 public:
  OdePlant(std::shared_ptr<const RobotModel> model, const World& world, const SimulationConfig& simulation,
           const PlantConditions& conditions, MotorBounds bounds)
      : Plant(*model, world),
        model_(std::move(model)),
        empty_(model_),
        step_(simulation.physics_step),
        bounds_(bounds),
        placed_(world),
        kinematics_(model_),
        contacts_(dJointGroupCreate(0)),
        arm_(world_.id(), model_, world.start.base, world.start.q, drop(*model_), mass_without_wheels(*model_),
             conditions),
        base_(OdeBase::make(world_.id(), *model_, arm_, world.start.base, conditions.floor_friction)) {
    const dWorldID id = world_.id();
    dWorldSetGravity(id, 0.0, 0.0, -kGravity);
    dWorldSetCFM(id, 1e-9);
    dWorldSetContactMaxCorrectingVel(id, 0.1);
    dWorldSetContactSurfaceLayer(id, kContactLayer);
    build();
    ramped_ = mean_ = VectorX::Zero(model_->base_dof());
    for (int i = 0; i < arm_.num_bodies(); ++i) bodies_.add(arm_.body(i));
    if (base_) base_->list_bodies(bodies_);
    place_objects(0.0);
  }

  void carry(const std::optional<Carried>& carried) override {
    ode::use_on_this_thread();
    kinematics_.update(state_.base, state_.q);
    model_ = with_carried(empty_, *model_, kinematics_.X_WE(), carried, placed_);
    dJointGroupEmpty(contacts_.get());
    build();
    place_objects(time_);
    solids_.X_WS.clear();
    in_body_.clear();
    detected_ = watching_ = touching_ = false;
  }

  void set_paces(std::span<const Pace> paces) override {
    scene_->set_paces(paces);
    place_objects(time_);
  }

  ~OdePlant() override {
    if (!world_.abandoned()) return;
    // The world's memory is leaked, so members that point into it must not be freed, either.
    (void)contacts_.release();
  }

  DetectorCheck cross_check() override { return scene_->cross_check(); }

  void check_start(PlantReport& report) override {
    report.clear();
    detect(time_, report);
  }

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    check_command(*model_, command, duration);
    report.clear();
    if (!failure_.empty()) {
      report.diverged = true;
      report.reason = failure_;
      return;
    }
    ode::use_on_this_thread();
    ode::take_lcp_messages();
    const int steps = std::max(1, static_cast<int>(std::ceil(duration / step_ - 1e-9)));
    const double h = duration / steps;
    if (!watching_) begin();
    for (int i = 0; i < steps; ++i) {
      const double end = i + 1 == steps ? time_ + duration : time_ + (i + 1) * h;
      if (!whole_step(command, time_ + i * h, end, h, report)) break;
    }
    enter(clock_, PlantPart::kRest);
    time_ += duration;
    check_upright(report);
  }

 private:
  static double drop(const RobotModel& model) { return model.base_dof() > 0 ? kStartDrop : 0.0; }
  static double mass_without_wheels(const RobotModel& model) {
    return std::max(0.0, model.base.mass - OdeBase::own_mass(model));
  }

  void build() {
    scene_.emplace(model_, placed_, true);
    watch_.emplace(*model_, placed_, scene_->meets_floor());
    for (const dBodyID body : object_bodies_)
      if (body != nullptr) dBodyDestroy(body);
    const World& world = placed_;
    kinematics_.update(world.start.base, world.start.q);
    scene_->place_robot(kinematics_);  // for shapes of a fixed base, which have no body
    for (int i = 0; i < static_cast<int>(model_->shapes.size()); ++i) {
      const CollisionShape& shape = model_->shape(i);
      const dGeomID geom = scene_->robot_geom(i);
      const dBodyID body = arm_.body_of_link(shape.link);
      if (geom == nullptr || body == nullptr) continue;
      dGeomSetBody(geom, body);
      ode::set_offset(geom, arm_.in_body(shape.link, shape.X_LS * scene_->robot_tilt(i)));
    }
    // Moving objects are kinematic bodies, so that contacts use their velocity.
    object_bodies_.assign(world.objects.size(), nullptr);
    for (std::size_t i = 0; i < world.objects.size(); ++i) {
      const dGeomID geom = scene_->object_geom(static_cast<int>(i));
      if (geom == nullptr || at_rest(world.objects[i].motion, 0.0)) continue;
      object_bodies_[i] = dBodyCreate(world_.id());
      dBodySetKinematic(object_bodies_[i]);
      dBodySetPosition(object_bodies_[i], dGeomGetPosition(geom)[0], dGeomGetPosition(geom)[1],
                       dGeomGetPosition(geom)[2]);
      dBodySetRotation(object_bodies_[i], dGeomGetRotation(geom));
      dGeomSetBody(geom, object_bodies_[i]);
    }
  }

  /// Sets poses and velocities of objects at a time of their motion.
  void place_objects(double time) {
    scene_->place_objects(time);
    for (std::size_t i = 0; i < object_bodies_.size(); ++i) {
      if (object_bodies_[i] == nullptr) continue;
      const Vector6& V = scene_->object_states()[i].V_WO_W;
      dBodySetAngularVel(object_bodies_[i], V[0], V[1], V[2]);
      dBodySetLinearVel(object_bodies_[i], V[3], V[4], V[5]);
    }
  }

  /// Ramps the base's command at its acceleration limits. A step of h seconds gets the ramp's mean, so that a base that
  /// follows it travels the same distance for any step.
  void ramp(const VectorX& command, double h) {
    const int dof = model_->base_dof();
    if (dof == 0) return;
    const auto follow = [h](auto now, const auto& wanted, double most, auto mean) {
      const VectorX change = wanted - now;
      const double time = std::min(change.norm() / most, h);  // remaining time of the ramp
      const VectorX before = now;
      now += time < h ? change : VectorX(change * (h * most / change.norm()));
      mean = now - (now - before) * (0.5 * time / h);
    };
    const Vector2& limit = model_->base.max_acceleration;
    follow(ramped_.head(dof - 1), command.head(dof - 1), limit.x(), mean_.head(dof - 1));
    follow(ramped_.tail(1), command.segment(dof - 1, 1), limit.y(), mean_.tail(1));
  }

  /// The quantities that a step changes besides BodyStates and the arm.
  auto changing(PlantReport& report) {
    return std::tie(state_, ramped_, height_, up_, bound_, report.slip_max, report.energy, report.lcp_messages);
  }

  void save(PlantReport& report) {
    before_ = changing(report);
    before_q_ = arm_.q();
  }

  void restore(PlantReport& report) {
    bodies_.restore();
    changing(report) = before_;
    arm_.set_q(before_q_);
  }

  /// Advances from `begin` to `end`, h seconds: in one step if nothing can touch on the way, otherwise in small steps
  /// with a contact check after each. False if the physics failed.
  bool whole_step(const VectorX& command, double begin, double end, double h, PlantReport& report) {
    const int parts = std::max(1, static_cast<int>(std::ceil(h / kContactStep - 1e-9)));
    if (!touching_) {
      save(report);
      if (!step(command, h, report)) return false;
      place_objects(end);
      enter(clock_, PlantPart::kCollide);
      find_solids();
      if (watch_->moves_clear(solids_, scene_->object_states())) return true;
      if (parts == 1) {
        detect(end, report);
        watch_->start(solids_, scene_->object_states());
        return true;
      }
      enter(clock_, PlantPart::kRest);
      restore(report);
      place_objects(begin);
      ++report.divided_steps;
    }
    for (int i = 1; i <= parts; ++i) {
      if (!step(command, h / parts, report)) return false;
      const double time = i == parts ? end : begin + i * (h / parts);
      place_objects(time);
      detect(time, report);
    }
    enter(clock_, PlantPart::kCollide);
    find_solids();
    watch_->start(solids_, scene_->object_states());
    return true;
  }

  /// One physics step. False if the physics failed; the report has the reason.
  bool step(const VectorX& command, double h, PlantReport& report) {
    enter(clock_, PlantPart::kRest);
    ramp(command, h);
    dWorldSetERP(world_.id(), error_reduction(h));
    if (base_) {
      base_->command(mean_, h);
      base_->add_floor_contacts(world_.id(), contacts_.get(), h);
    }
    arm_.command(command.tail(model_->num_joints()), h);
    arm_.before_step();
    const bool free = bounds_ == MotorBounds::kWhereTheyBind && !bound_ && arm_.clear_of_stops();
    set_bounded(!free);
    bodies_.save();
    enter(clock_, PlantPart::kStep);
    if (!solve(h, report)) return false;
    if (free && !(load() < 1.0)) {
      bodies_.restore();
      ode::take_lcp_messages();  // messages of the discarded solution
      set_bounded(true);
      ++report.redone_steps;
      if (!solve(h, report)) return false;
    }
    enter(clock_, PlantPart::kRest);
    bound_ = !(load() < kNearlyBound);
    report.lcp_messages += ode::take_lcp_messages();
    dJointGroupEmpty(contacts_.get());
    touching_ = false;
    if (!read_state(h)) return fail(report, "a body's state is not finite, or faster than 20 m/s");
    if (base_) {
      report.slip_max = std::max(report.slip_max, base_->slip());
      report.energy += base_->power() * h;
    }
    report.energy += arm_.power() * h;
    return true;
  }

  bool solve(double h, PlantReport& report) {
    try {
      if (dWorldStep(world_.id(), h) == 0) return fail(report, "ODE's step gave up");
    } catch (const ode::Fault& fault) {
      world_.abandon();
      return fail(report, fault.what());
    }
    arm_.after_step();
    return true;
  }

  void set_bounded(bool bounded) {
    arm_.set_bounded(bounded);
    if (base_) base_->set_bounded(bounded);
  }

  double load() const { return std::max(arm_.load(), base_ ? base_->load() : 0.0); }

  bool fail(PlantReport& report, const std::string& reason) {
    failure_ = fmt::format("diverged: {}", reason);
    report.diverged = true;
    report.reason = failure_;
    return false;
  }

  /// Reads the state after a step of h seconds.
  bool read_state(double h) {
    if (!bodies_.healthy(kTopSpeed)) return false;
    arm_.read(state_.q, state_.qdot.tail(model_->num_joints()));
    if (base_) read_base(h);
    return state_.q.allFinite() && state_.qdot.allFinite() && state_.base.allFinite();
  }

  void read_base(double h) {
    const dBodyID body = arm_.body(0);
    const Isometry X_WB = ode::pose(body) * arm_.in_body(0, Isometry::Identity());
    const Vector3 forward = X_WB.linear().col(0);
    const double heading = std::atan2(forward.y(), forward.x());
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const double phi = heading + kTurn * std::round((state_.base.z() - heading) / kTurn);
    state_.base = {X_WB.translation().x(), X_WB.translation().y(), phi};
    height_ = X_WB.translation().z();
    up_ = X_WB.linear()(2, 2);

    // A body's velocity is its mean over the step: along the chord, at the base's heading half-way.
    const Vector3 w = ode::from_vector(dBodyGetAngularVel(body));
    const Vector3 lever = X_WB.linear().transpose() * (X_WB.translation() - ode::from_vector(dBodyGetPosition(body)));
    const Vector3 v_centre = ode::from_vector(dBodyGetLinearVel(body));
    const double middle = phi - 0.5 * h * w.z();
    const double c = std::cos(middle), s = std::sin(middle);
    const Vector3 v = Vector3(c * v_centre.x() + s * v_centre.y(), c * v_centre.y() - s * v_centre.x(), 0.0) +
                      Vector3(0.0, 0.0, w.z()).cross(lever);
    kind_of(model_->base.type).set_coordinates({v.x(), v.y(), w.z()}, state_.qdot);
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

  void begin() {
    PlantReport ignored;
    if (!detected_) detect(time_, ignored);
    find_solids();
    watch_->start(solids_, scene_->object_states());
    watching_ = true;
  }

  void find_solids() {
    if (solids_.X_WS.empty()) {
      kinematics_.update(state_.base, state_.q);  // for shapes of a fixed base, which have no body
      for (const CollisionShape& shape : model_->shapes) {
        const bool moves = arm_.body_of_link(shape.link) != nullptr;
        solids_.X_WS.push_back(kinematics_.X_WS(shape));
        in_body_.push_back(moves ? arm_.in_body(shape.link, shape.X_LS) : Isometry::Identity());
      }
    }
    for (std::size_t i = 0; i < in_body_.size(); ++i)
      if (const dBodyID body = arm_.body_of_link(model_->shapes[i].link))
        solids_.X_WS[i] = ode::pose(body) * in_body_[i];
    if (base_) solids_.X_WB = ode::pose(arm_.body(0));
  }

  /// Reports the contacts of the present state, and creates contact joints for the next step.
  void detect(double time, PlantReport& report) {
    enter(clock_, PlantPart::kCollide);
    ContactLog log(report.contacts);
    dJointGroupEmpty(contacts_.get());
    touching_ = false;
    scene_->detect([&](const Touch& touch) {
      touching_ = true;
      log.add(touch, time);
      join(touch);
    });
    if (scene_->has_exact()) {
      kinematics_.update(state_.base, state_.q);
      scene_->detect_exact(kinematics_, time, log);
    }
    log.sort();
    detected_ = true;
  }

  /// Creates the contact joints of two solids for the next step.
  void join(const Touch& touch) {
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
  std::shared_ptr<const RobotModel> model_, empty_;  // with and without what it carries
  double step_;
  MotorBounds bounds_;
  ode::World world_;
  World placed_;
  std::optional<ContactScene> scene_;
  Kinematics kinematics_;
  ode::JointGroup contacts_;
  OdeArm arm_;
  std::unique_ptr<OdeBase> base_;
  std::vector<dBodyID> object_bodies_;
  ode::BodyStates bodies_;
  std::optional<GapWatch> watch_;
  SolidPoses solids_;
  std::vector<Isometry> in_body_;  // pose of each shape in its body's frame

  std::tuple<PlantState, VectorX, double, double, bool, double, double, int> before_;  // saved changing()
  VectorX before_q_;                                                                   // of the arm
  VectorX ramped_;  // the base's command after its acceleration limits
  VectorX mean_;    // mean of `ramped_` over a step
  double height_ = 0.0;
  double up_ = 1.0;
  bool detected_ = false;
  bool watching_ = false;
  bool touching_ = false;  // contact joints with objects or between links exist
  bool bound_ = false;     // a motor was at or near its limit in the last step
  std::string failure_;
};

}  // namespace

std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                      const SimulationConfig& simulation, const PlantConditions& conditions,
                                      MotorBounds bounds) {
  return std::make_unique<OdePlant>(std::move(model), world, simulation, conditions, bounds);
}

}  // namespace moma
