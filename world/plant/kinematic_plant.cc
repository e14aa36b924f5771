#include "world/plant/plant.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "world/plant/contacts.h"
#include "world/plant/reach_watch.h"

namespace moma {
namespace {

constexpr double kContactInterval = 0.005;  // [s]

class KinematicPlant final : public Plant, private TouchSink {
 public:
  KinematicPlant(std::shared_ptr<const RobotModel> model, const World& world, bool stops, ContactChecks checks)
      : model_(std::move(model)), kinematics_(model_), scene_(model_, world, false), stops_(stops) {
    state_.base = world.start.base;
    state_.q = world.start.q;
    state_.qdot = VectorX::Zero(model_->num_velocities());
    q_ = state_.q;
    if (checks == ContactChecks::kAll) return;
    gaps_.emplace(*model_, world);
    watch_.emplace(model_, solid_pairs(*model_, world.objects.size(), scene_.meets_floor()), world.objects.size());
    travel_ = watch_->rest();
  }

  const PlantState& state() const override { return state_; }
  double time() const override { return time_; }

  DetectorCheck cross_check() override {
    kinematics_.update(state_.base, state_.q);
    scene_.place_robot(kinematics_);
    scene_.place_objects(time_);
    return scene_.cross_check();
  }

  void check_start(PlantReport& report) override {
    report = PlantReport();
    enter(clock_, PlantPart::kCollide);
    detect(state_.base, state_.q, time_, nullptr, report);
    enter(clock_, PlantPart::kRest);
  }

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    check_command(*model_, command, duration);
    report.clear();
    Vector3 base = state_.base;
    move(command, duration, base);
    enter(clock_, PlantPart::kCollide);
    const std::vector<SolidPair>* pairs = nullptr;  // all pairs
    if (watch_ && base.allFinite() && q_.allFinite()) pairs = &near(command, duration, base);
    if (pairs == nullptr || !pairs->empty()) {
      look(command, duration, pairs, report);
    } else {
      state_.base = base;
      state_.q = q_;
    }
    if (watch_) watch_->end();
    enter(clock_, PlantPart::kRest);
    state_.qdot = command;
    time_ += duration;
  }

 private:
  static int checks_in(double duration) {
    return std::max(1, static_cast<int>(std::ceil(duration / kContactInterval - 1e-9)));
  }

  /// Time of check i of n after the command's start. The last check is at the end.
  static double time_of(int i, int n, double duration) { return i == n ? duration : duration * i / n; }

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

  /// Returns the pairs that may touch on the way to (base, q_).
  const std::vector<SolidPair>& near(const VectorX& command, double duration, const Vector3& base) {
    watch_->between(state_.base, state_.q, base, q_, travel_);
    // A joint that stops at a limit may go all the way to it; any other joint goes as far as commanded.
    if (model_->mobile()) travel_.base = command.head(model_->base_dof() - 1).norm() * duration;
    travel_.joints = travel_.joints.cwiseMax(duration * command.tail(model_->num_joints()).cwiseAbs());
    if (scene_.objects_move()) measure_objects(duration);
    watch_->begin(travel_);
    bool updated = false;
    return watch_->within({0.0, 0.0, 0.0}, [&](const SolidPair& pair) {
      if (!updated) kinematics_.update(state_.base, state_.q);
      updated = true;
      return gaps_->gap(pair, kinematics_, scene_.objects_move() ? objects_ : scene_.object_states(), 0.0).least;
    });
  }

  /// Measures how far objects move between checks, and their present poses.
  void measure_objects(double duration) {
    scene_.place_objects(time_);
    objects_ = scene_.object_states();
    before_ = objects_;
    travel_.objects.setZero();
    const int checks = checks_in(duration);
    for (int i = 1; i <= checks; ++i) {
      scene_.place_objects(time_ + time_of(i, checks, duration));
      const std::vector<ObjectState>& now = scene_.object_states();
      for (std::size_t k = 0; k < now.size(); ++k)
        travel_.objects[static_cast<Eigen::Index>(k)] += moved(before_[k].X_WO, now[k].X_WO, gaps_->object_radius(k));
      before_ = now;
    }
  }

  /// Moves along the command and checks these pairs, or all, for contact.
  void look(const VectorX& command, double duration, const std::vector<SolidPair>* pairs, PlantReport& report) {
    const int checks = checks_in(duration);
    Vector3 base;
    for (int i = 1; i <= checks; ++i) {
      const double dt = time_of(i, checks, duration);
      move(command, dt, base);
      if (!base.allFinite() || !q_.allFinite()) {
        report.diverged = true;
        report.reason = "the state is not finite";
        return;
      }
      detect(base, q_, time_ + dt, pairs, report);
    }
    state_.base = base;
    state_.q = q_;
  }

  void detect(const Vector3& base, const VectorX& q, double time, const std::vector<SolidPair>* pairs,
              PlantReport& report) {
    kinematics_.update(base, q);
    scene_.place_objects(time);
    ContactLog log(report.contacts);
    log_ = &log;
    now_ = time;
    bool exact = pairs == nullptr;
    if (pairs == nullptr) {
      scene_.place_robot(kinematics_);
      scene_.detect(*this);
    } else {
      for (const SolidPair& pair : *pairs) {
        if (!scene_.decides(pair)) {
          exact = true;
          continue;
        }
        scene_.place_shape(pair.first, kinematics_);
        if (pair.kind == PairKind::kSelf) scene_.place_shape(pair.second, kinematics_);
        scene_.detect(pair, *this);
      }
    }
    if (exact) scene_.detect_exact(kinematics_, time, log);
    log.sort();
    log_ = nullptr;
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
  std::optional<PairGaps> gaps_;  // both only with ContactChecks::kWhereSomethingMayTouch
  std::optional<ReachWatch> watch_;
  ReachWatch::Travel travel_;
  std::vector<ObjectState> objects_, before_;  // at the start of a command; at the previous check
  PlantState state_;
  VectorX q_;
  double time_ = 0.0;
  ContactLog* log_ = nullptr;
  double now_ = 0.0;
};

}  // namespace

std::unique_ptr<Plant> make_kinematic_plant(std::shared_ptr<const RobotModel> model, const World& world, bool stops,
                                            ContactChecks checks) {
  return std::make_unique<KinematicPlant>(std::move(model), world, stops, checks);
}

}  // namespace moma
