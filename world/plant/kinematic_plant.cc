#include "world/plant/kinematic_plant.h"

#include <algorithm>
#include <cmath>

#include "world/plant/command_check.h"
#include "world/plant/contacts.h"

namespace moma {
namespace {

constexpr double kContactInterval = 0.005;  // [s]

class KinematicPlant final : public Plant, private TouchSink {
 public:
  KinematicPlant(std::shared_ptr<const RobotModel> model, const World& world, bool stops)
      : model_(std::move(model)), kinematics_(model_), scene_(model_, world, false), stops_(stops) {
    state_.base = world.start.base;
    state_.q = world.start.q;
    state_.qdot = VectorX::Zero(model_->num_velocities());
    q_ = state_.q;
  }

  const PlantState& state() const override { return state_; }
  double time() const override { return time_; }
  DetectorCheck cross_check() override { return scene_.cross_check(); }

  void check_start(PlantReport& report) override {
    report = PlantReport();
    detect(state_.base, state_.q, time_, report);
  }

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    check_command(*model_, command, duration);
    clear(report);
    const int checks = std::max(1, static_cast<int>(std::ceil(duration / kContactInterval - 1e-9)));
    for (int i = 1; i <= checks; ++i) {
      // From the beginning each time, so that the end does not depend on how often contact is checked.
      const double dt = i == checks ? duration : duration * i / checks;
      Vector3 base = state_.base;
      q_ = state_.q;
      integrate(*model_, base, q_, command, dt);
      if (stops_) stop_at_limits();
      if (!base.allFinite() || !q_.allFinite()) {
        report.diverged = true;
        report.reason = "the state is not finite";
        break;
      }
      detect(base, q_, time_ + dt, report);
      if (i == checks) {
        state_.base = base;
        state_.q = q_;
      }
    }
    state_.qdot = command;
    time_ += duration;
  }

 private:
  /// Keeps the vector's memory.
  static void clear(PlantReport& report) {
    std::vector<Contact> contacts = std::move(report.contacts);
    contacts.clear();
    report = PlantReport();
    report.contacts = std::move(contacts);
  }

  void stop_at_limits() {
    for (int i = 0; i < model_->num_joints(); ++i) {
      const ControlledJoint& joint = model_->joints[static_cast<std::size_t>(i)];
      q_[i] = std::min(std::max(q_[i], joint.lower), joint.upper);
    }
  }

  void detect(const Vector3& base, const VectorX& q, double time, PlantReport& report) {
    enter(clock_, PlantPart::kCollide);
    kinematics_.update(base, q);
    scene_.place_robot(kinematics_);
    scene_.place_objects(time);
    ContactLog log(report.contacts);
    log_ = &log;
    now_ = time;
    scene_.detect(*this);
    scene_.detect_exact(kinematics_, time, log);
    log.sort();
    log_ = nullptr;
    enter(clock_, PlantPart::kRest);
  }

  void touch(const Touch& touch) override {
    double depth = 0.0;
    for (int i = 0; i < touch.count; ++i) depth = std::max(depth, static_cast<double>(touch.points[i].depth));
    log_->add({touch.kind, touch.first, touch.second, depth, now_, true});
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  ContactScene scene_;
  bool stops_;
  PlantState state_;
  VectorX q_;
  double time_ = 0.0;
  ContactLog* log_ = nullptr;
  double now_ = 0.0;
};

}  // namespace

std::unique_ptr<Plant> make_kinematic_plant(std::shared_ptr<const RobotModel> model, const World& world, bool stops) {
  return std::make_unique<KinematicPlant>(std::move(model), world, stops);
}

}  // namespace moma
