#include "world/plant/plant.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "world/plant/contacts.h"
#include "world/plant/gap_watch.h"

namespace moma {
namespace {

constexpr double kContactInterval = 0.005;  // [s]

class KinematicPlant final : public Plant {
 public:
  KinematicPlant(std::shared_ptr<const RobotModel> model, const World& world, bool stops, ContactChecks checks)
      : Plant(*model, world),
        model_(std::move(model)),
        empty_(model_),
        world_(world),
        kinematics_(model_),
        stops_(stops),
        checks_(checks),
        q_(world.start.q) {
    build();
  }

  void carry(const std::optional<Carried>& carried) override {
    kinematics_.update(state_.base, state_.q);
    model_ = with_carried(empty_, *model_, kinematics_.X_WE(), carried, world_);
    build();
  }

  void set_paces(std::span<const Pace> paces) override { scene_->set_paces(paces); }

  DetectorCheck cross_check() override {
    place(state_.base, state_.q, time_);
    scene_->place_robot(kinematics_);
    return scene_->cross_check();
  }

  void check_start(PlantReport& report) override {
    report = PlantReport();
    enter(clock_, PlantPart::kCollide);
    place(state_.base, state_.q, time_);
    detect(time_, report);
    enter(clock_, PlantPart::kRest);
  }

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    check_command(*model_, command, duration);
    report.clear();
    enter(clock_, PlantPart::kCollide);
    if (!watching_) begin();
    Vector3 base;
    const bool clear = moves_clear(command, duration, base);
    const int checks = clear ? 0 : std::max(1, static_cast<int>(std::ceil(duration / kContactInterval - 1e-9)));
    for (int i = 1; i <= checks && !report.diverged; ++i) {
      const double dt = i == checks ? duration : duration * i / checks;
      move(command, dt, base);
      report.diverged = !base.allFinite() || !q_.allFinite();
      if (!report.diverged) look(base, time_ + dt, report);
    }
    enter(clock_, PlantPart::kRest);
    if (report.diverged) {
      report.reason = "the state is not finite";
    } else {
      state_.base = base;
      state_.q = q_;
    }
    state_.qdot = command;
    time_ += duration;
  }

 private:
  void build() {
    scene_.emplace(model_, world_, false);
    watch_.emplace(*model_, world_, scene_->meets_floor());
    solids_.X_WS.resize(model_->shapes.size());
    watching_ = false;
    reach_ = 0.0;
    for (const CollisionShape& shape : model_->shapes)
      reach_ = std::max(reach_, shape.X_LS.translation().norm() + bounding_radius(shape.shape));
    for (const Link& link : model_->links) reach_ += link.X_PJ.translation().norm();
    for (const ControlledJoint& joint : model_->joints)
      if (joint.type == JointType::kPrismatic) reach_ += std::max(std::abs(joint.lower), std::abs(joint.upper));
  }

  /// Integrates from the start of the command each time, so that the end does not depend on the number of checks. False
  /// if a joint comes to its stop.
  bool move(const VectorX& command, double dt, Vector3& base) {
    base = state_.base;
    q_ = state_.q;
    integrate(*model_, base, q_, command, dt);
    bool free = true;
    for (int i = 0; stops_ && i < model_->num_joints(); ++i) {
      const ControlledJoint& joint = model_->joint(i);
      const double q = std::min(std::max(q_[i], joint.lower), joint.upper);
      free = free && q == q_[i];
      q_[i] = q;
    }
    return free;
  }

  /// Moves along the whole command. True if nothing can come into contact on the way, which most commands do not need
  /// intermediate checks for. Only among objects at rest, and if no joint comes to a stop: a point of the robot then
  /// has an acceleration of at most omega (omega reach + 2 v), with the sums omega and v of all angular and linear
  /// speeds, and deviates from a straight line by at most an eighth of that times the duration squared.
  bool moves_clear(const VectorX& command, double duration, Vector3& base) {
    if (checks_ != ContactChecks::kWhereSomethingMayTouch || scene_->objects_move()) return false;
    if (!move(command, duration, base) || !base.allFinite() || !q_.allFinite()) return false;
    const int first = model_->base_dof();
    double omega = first > 0 ? std::abs(command[first - 1]) : 0.0, v = first > 0 ? command.head(first - 1).norm() : 0.0;
    for (int i = 0; i < model_->num_joints(); ++i)
      (model_->joint(i).type == JointType::kPrismatic ? v : omega) += std::abs(command[first + i]);
    place(base, q_, time_ + duration);
    return watch_->moves_clear(solids_, scene_->object_states(),
                               0.125 * omega * (omega * reach_ + 2.0 * v) * duration * duration);
  }

  void place(const Vector3& base, const VectorX& q, double time) {
    kinematics_.place(base, q);
    scene_->place_objects(time);
    solids_.X_WB = kinematics_.X_WB();
    for (std::size_t i = 0; i < solids_.X_WS.size(); ++i) solids_.X_WS[i] = kinematics_.X_WS(model_->shapes[i]);
  }

  void begin() {
    place(state_.base, state_.q, time_);
    watch_->start(solids_, scene_->object_states());
    watching_ = true;
  }

  /// Checks (base, q_) for contact unless nothing can have come into contact since the check before.
  void look(const Vector3& base, double time, PlantReport& report) {
    place(base, q_, time);
    if (checks_ == ContactChecks::kWhereSomethingMayTouch && watch_->moves_clear(solids_, scene_->object_states()))
      return;
    detect(time, report);
    watch_->start(solids_, scene_->object_states());
  }

  /// Reports the contacts of the present places.
  void detect(double time, PlantReport& report) {
    ContactLog log(report.contacts);
    scene_->place_robot(kinematics_);
    scene_->detect([&](const Touch& touch) { log.add(touch, time); });
    scene_->detect_exact(kinematics_, time, log);
    log.sort();
  }

  std::shared_ptr<const RobotModel> model_, empty_;  // with and without what it carries
  World world_;
  Kinematics kinematics_;
  std::optional<ContactScene> scene_;
  std::optional<GapWatch> watch_;
  SolidPoses solids_;
  bool stops_;
  double reach_ = 0.0;  // bound on the distance of two points of the robot [m]
  ContactChecks checks_;
  bool watching_ = false;
  VectorX q_;
};

}  // namespace

std::unique_ptr<Plant> make_kinematic_plant(std::shared_ptr<const RobotModel> model, const World& world, bool stops,
                                            ContactChecks checks) {
  return std::make_unique<KinematicPlant>(std::move(model), world, stops, checks);
}

}  // namespace moma
