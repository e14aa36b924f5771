#include "world/plant/plant.h"

#include <algorithm>
#include <cmath>

#include "world/plant/contacts.h"
#include "world/plant/gap_watch.h"

namespace moma {
namespace {

constexpr double kContactInterval = 0.005;  // [s]

class KinematicPlant final : public Plant {
 public:
  KinematicPlant(std::shared_ptr<const RobotModel> model, const World& world, bool stops, ContactChecks checks)
      : model_(std::move(model)),
        kinematics_(model_),
        scene_(model_, world, false),
        watch_(*model_, world, scene_.meets_floor()),
        stops_(stops),
        checks_(checks) {
    state_.base = world.start.base;
    state_.q = world.start.q;
    state_.qdot = VectorX::Zero(model_->num_velocities());
    q_ = state_.q;
    solids_.X_WS.resize(model_->shapes.size());
  }

  const PlantState& state() const override { return state_; }
  double time() const override { return time_; }

  DetectorCheck cross_check() override {
    place(state_.base, state_.q, time_);
    scene_.place_robot(kinematics_);
    return scene_.cross_check();
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
    const int checks = std::max(1, static_cast<int>(std::ceil(duration / kContactInterval - 1e-9)));
    Vector3 base;
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
  /// Integrates from the start of the command each time, so that the end does not depend on the number of checks.
  void move(const VectorX& command, double dt, Vector3& base) {
    base = state_.base;
    q_ = state_.q;
    integrate(*model_, base, q_, command, dt);
    if (!stops_) return;
    for (int i = 0; i < model_->num_joints(); ++i) {
      const ControlledJoint& joint = model_->joints[static_cast<std::size_t>(i)];
      q_[i] = std::min(std::max(q_[i], joint.lower), joint.upper);
    }
  }

  void place(const Vector3& base, const VectorX& q, double time) {
    kinematics_.place(base, q);
    scene_.place_objects(time);
    solids_.X_WB = kinematics_.X_WB();
    for (std::size_t i = 0; i < solids_.X_WS.size(); ++i) solids_.X_WS[i] = kinematics_.X_WS(model_->shapes[i]);
  }

  void begin() {
    place(state_.base, state_.q, time_);
    watch_.start(solids_, scene_.object_states());
    watching_ = true;
  }

  /// Checks (base, q_) for contact unless nothing can have come into contact since the check before.
  void look(const Vector3& base, double time, PlantReport& report) {
    place(base, q_, time);
    if (checks_ == ContactChecks::kWhereSomethingMayTouch && watch_.moves_clear(solids_, scene_.object_states()))
      return;
    detect(time, report);
    watch_.start(solids_, scene_.object_states());
  }

  /// Reports the contacts of the present places.
  void detect(double time, PlantReport& report) {
    ContactLog log(report.contacts);
    scene_.place_robot(kinematics_);
    scene_.detect([&](const Touch& touch) { log.add(touch, time); });
    scene_.detect_exact(kinematics_, time, log);
    log.sort();
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  ContactScene scene_;
  GapWatch watch_;
  SolidPoses solids_;
  bool stops_;
  ContactChecks checks_;
  bool watching_ = false;
  PlantState state_;
  VectorX q_;
  double time_ = 0.0;
};

}  // namespace

std::unique_ptr<Plant> make_kinematic_plant(std::shared_ptr<const RobotModel> model, const World& world, bool stops,
                                            ContactChecks checks) {
  return std::make_unique<KinematicPlant>(std::move(model), world, stops, checks);
}

}  // namespace moma
