#include "controller/safe/predictor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "controller/model/kinematics.h"
#include "controller/step_described.h"

namespace moma {
namespace {

// Contribution of noise to every misfit: (0.01 m/s)^2 + (0.01 rad/s)^2, and the same for joints.
constexpr double kFloor = 2e-4;

// Part of a period by which a velocity may be earlier or later than a whole number of periods without a misfit.
constexpr double kPartOfPeriod = 0.35;

// Noise of a velocity by which gains are judged, and the bounds of a gain.
constexpr double kVelocityNoise = 0.01;
constexpr double kFollows = 1e-6;  // of a drive's velocity from its command

// Shares of the drive's acceleration: from which on it is hard, and that a base that slips does at least.
constexpr double kHard = 0.5;
constexpr double kLeastDone = 0.25;

// Shares of the drive's accelerations that are compared.
constexpr auto kDrives = std::to_array<BaseRamp::Shares>(
    {{}, {1.0, 0.75}, {1.0, 0.5}, {1.0, 1.0 / 3.0}, {0.75, 0.75}, {0.5, 0.5}, {1.0 / 3.0, 1.0 / 3.0}});
constexpr int kNumDrives = static_cast<int>(kDrives.size());

int whole_periods(double seconds, double dt) noexcept { return static_cast<int>(std::ceil(seconds / dt - 1e-9)); }

// Moves the base alone.
void move(const RobotModel& model, Vector3& base, const Vector3& velocity, double dt) noexcept {
  VectorX no_joints;
  integrate(model, base, no_joints, velocity.head(model.base_dof()), dt);
}

// Threshold for a vector's length: its three axes together.
MotionThreshold motion_threshold(const UncertaintyParams& u, double quantile) noexcept {
  if (!u.enabled) return {};
  const double size = quantile * std::numbers::sqrt3;
  return {size * u.object_velocity, size * u.object_angular_velocity, quantile};
}

std::size_t at(int age) noexcept { return static_cast<std::size_t>(age); }

// Makes the oldest entry the latest, to be overwritten.
template <class T>
T& shifted(std::vector<T>& latest_first) noexcept {
  std::rotate(latest_first.begin(), latest_first.end() - 1, latest_first.end());
  return latest_first.front();
}

// Repeats the latest entry.
template <class T>
void repeat(std::vector<T>& latest_first) noexcept {
  shifted(latest_first) = latest_first[1];
}

}  // namespace

Predictor::Predictor(const RobotModel& model, const PredictionParams& params, const UncertaintyParams& uncertainty,
                     double base_share, double control_period, const VectorX& acceleration_limit)
    : model_(&model),
      params_(params),
      dt_(control_period),
      base_dof_(model.base_dof()),
      num_joints_(model.num_joints()),
      ramp_(model),
      base_share_(base_share),
      uncertain_(uncertainty),
      uncertainty_(uncertainty, base_dof_),
      filter_({params.resting_filter, params.moving_filter, params.twist_filter, params.estimation.jump},
              motion_threshold(uncertainty, uncertainty_.quantile()), control_period),
      object_memory_(model, params.memory, control_period),
      base_age_(whole_periods(params.base_sensing, dt_)),
      joint_age_(whole_periods(params.joint_sensing, dt_)),
      object_age_(whole_periods(params.object_sensing, dt_)),
      goal_age_(whole_periods(params.goal_sensing, dt_)) {
  const int base_trip = whole_periods(params.base_drive, dt_) + base_age_;
  const int joint_trip = whole_periods(params.joint_drive, dt_) + joint_age_;
  tried_ = std::max(params.estimation.least_tried, params.estimation.beyond + std::max(base_trip, joint_trip));
  // The commands of the longest round trip, one before it, and the waiting ones, which are at most as many as the trip.
  periods_ = tried_ + 2;
  joint_step_ = VectorX::Constant(num_joints_, kInfinity);
  if (acceleration_limit.size() == model.num_velocities()) joint_step_ = dt_ * acceleration_limit.tail(num_joints_);
  base_speed_.head(base_dof_) = model.velocity_limits().head(base_dof_);
  if (params.identify && params.estimation.gain > 0.0)
    gain_prior_ = kVelocityNoise * kVelocityNoise / (params.estimation.gain * params.estimation.gain);
  out_.q = VectorX::Zero(num_joints_);
  out_.qdot = VectorX::Zero(model.num_velocities());
  reset({});
}

void Predictor::reset(std::span<const ObjectShape> objects, std::size_t more) {
  object_memory_.set_objects(objects);
  const std::size_t num_objects = objects.size();
  PredictionMemory& m = memory_;
  m = {};
  const int nv = base_dof_ + num_joints_;
  m.computed.assign(at(periods_), VectorX::Zero(nv));
  m.sent.assign(at(periods_), VectorX::Zero(nv));
  m.base_velocity.assign(at(periods_), Vector3::Zero());
  const int pairs = tried_ * kNumDrives;
  m.base_trip = {base_dof_ > 0 ? whole_periods(params_.base_drive, dt_) + base_age_ : 0, VectorX::Zero(pairs)};
  m.joint_trip = {whole_periods(params_.joint_drive, dt_) + joint_age_, VectorX::Zero(tried_)};
  m.driven.assign(at(pairs), Vector3::Zero());
  m.objects.assign(num_objects, PoseTrack{});
  out_.objects.assign(num_objects + more, ObjectState{});
  out_.qdot.setZero();
  spreads_.assign(uncertainty_.on() ? num_objects : 0, PlaceSpread{});
  ramp_.set_shares({});
  synchronise();
}

void Predictor::set_memory(const PredictionMemory& memory) noexcept {
  memory_ = memory;
  ramp_.set_shares(kDrives[at(memory_.drive)]);
  synchronise();
}

// Sets the waiting times of base and joints with which they act together: at the longer latency of their drives.
void Predictor::synchronise() noexcept {
  const int base = base_dof_ > 0 ? std::max(0, memory_.base_trip.periods - base_age_) : 0;
  const int joints = num_joints_ > 0 ? std::max(0, memory_.joint_trip.periods - joint_age_) : 0;
  late_ = std::max(base, joints);
  hold_base_ = late_ - base;
  hold_joints_ = late_ - joints;
  if (base_dof_ == 0) hold_base_ = 0;
}

BaseRamp::Shares Predictor::drive() const noexcept {
  return {memory_.kept * kDrives[at(memory_.drive)].speeding, memory_.kept * memory_.slowing};
}

const Vector3& Predictor::driven(int drive, int age) const noexcept { return memory_.driven[at(drive * tried_ + age)]; }

// Advances the base's velocity by the period in which the command sent last acts: by its ramp, and by each drive's.
void Predictor::follow_command() noexcept {
  PredictionMemory& m = memory_;
  const Vector3 command = followed_command(0);
  Vector3 latest = m.base_velocity.front();
  ramp_.follow(command, dt_, latest);
  shifted(m.base_velocity) = latest;
  if (!params_.identify || base_dof_ == 0) return;
  BaseRamp ramp = ramp_;
  for (int i = 0; i < kNumDrives; ++i) {
    ramp.set_shares(kDrives[at(i)]);
    Vector3 velocity = driven(i, 0);
    ramp.follow(command, dt_, velocity);
    const auto first = m.driven.begin() + i * tried_;
    std::rotate(first, first + tried_ - 1, first + tried_);
    *first = velocity;
  }
}

// Estimates the round trip and the drive together. A slow drive with the configured latency and a quick drive with a
// longer one look alike for a while; estimated one after the other, each would absorb the other's error. A delay of up
// to kPartOfPeriod of a period, either way, is no misfit. A drive replaces the present one only if its misfit is
// clearly below that of the present drive at every round trip.
bool Predictor::identify_base(const Observation& o) noexcept {
  PredictionMemory& m = memory_;
  const EstimationParams& e = params_.estimation;
  for (int i = 0; i < kNumDrives; ++i)
    for (int age = 0; age < tried_; ++age) {
      const Vector3& then = driven(i, age);
      const Vector3 later = then + kPartOfPeriod * (driven(i, std::max(age - 1, 0)) - then);
      const Vector3 earlier = then + kPartOfPeriod * (driven(i, std::min(age + 1, tried_ - 1)) - then);
      double misfit = 0.0;
      for (int k = 0; k < base_dof_; ++k) {
        const auto [low, high] = std::minmax(later[k], earlier[k]);
        const double off = o.qdot[k] - std::clamp(o.qdot[k], low, high);
        misfit += off * off;
      }
      settle(m.base_trip.misfit, i * tried_ + age, misfit, dt_ / e.forget);
    }
  const auto present = m.base_trip.misfit.segment(m.drive * tried_, tried_);
  Eigen::Index nearest = 0;
  present.minCoeff(&nearest);
  const int best = chosen(m.base_trip.misfit, m.drive * tried_ + static_cast<int>(nearest), kFloor, e.better);
  const int drive = best / tried_;
  const int trip = drive == m.drive ? chosen(present, m.base_trip.periods, kFloor, e.better) : best % tried_;
  if (drive != m.drive) {
    m.drive = drive;
    m.slowing = std::min(m.slowing, kDrives[at(drive)].slowing);
    ramp_.set_shares(kDrives[at(drive)]);
    // Sums about another drive tell nothing.
    m.gain_measured.setZero();
    m.gain_commanded.setZero();
    m.asked.setZero();
    m.behind.setZero();
  }
  if (trip == m.base_trip.periods) return false;
  m.base_trip.periods = trip;
  m.begun = false;  // the filtered pose belongs to another time
  return true;
}

// While a drive speeds up or slows down, its velocity tells nothing of its gain.
void Predictor::identify_gains(const Observation& o) noexcept {
  PredictionMemory& m = memory_;
  const Vector3 command = ramp_.base_of(m.sent[at(m.base_trip.periods)]);
  const Vector3 follows = gains().cwiseProduct(command) - driven(m.drive, m.base_trip.periods);
  if (gain_prior_ == 0.0 || slips() || follows.cwiseAbs().maxCoeff() > kFollows) return;
  const double kept = 1.0 - std::min(1.0, dt_ / params_.estimation.gain_forget);
  for (int i = 0; i < base_dof_; ++i) {
    m.gain_measured[i] = kept * m.gain_measured[i] + o.qdot[i] * command[i];
    m.gain_commanded[i] = kept * m.gain_commanded[i] + command[i] * command[i];
  }
}

Vector3 Predictor::gains() const noexcept {
  Vector3 gains = Vector3::Ones();
  if (gain_prior_ == 0.0) return gains;
  for (int i = 0; i < base_dof_; ++i)
    gains[i] = std::clamp((memory_.gain_measured[i] + gain_prior_) / (memory_.gain_commanded[i] + gain_prior_),
                          params_.estimation.least_gain, params_.estimation.largest_gain);
  return gains;
}

// Returns the velocity that the base takes by the command sent `age` periods before the latest.
Vector3 Predictor::followed_command(int age) const noexcept {
  return gains().cwiseProduct(ramp_.base_of(memory_.sent[at(age)]));
}

void Predictor::identify(const Observation& o) noexcept {
  PredictionMemory& m = memory_;
  const EstimationParams& e = params_.estimation;
  for (int age = 0; age < tried_; ++age)
    settle(m.joint_trip.misfit, age, (o.qdot.tail(num_joints_) - m.sent[at(age)].tail(num_joints_)).squaredNorm(),
           dt_ / e.forget);
  const int joint_trip = chosen(m.joint_trip.misfit, m.joint_trip.periods, kFloor, e.better);
  bool changed = joint_trip != m.joint_trip.periods;
  m.joint_trip.periods = joint_trip;
  if (base_dof_ > 0) {
    if (identify_base(o)) changed = true;
    identify_gains(o);
  }
  if (!changed) return;
  const int waited = hold_joints_;
  synchronise();
  if (hold_joints_ < waited) memory_.catching_up = true;
}

// Returns the mean velocity of the base in the period in which the command sent `age` periods before the latest acts.
Vector3 Predictor::mean_velocity(int age) const noexcept {
  Vector3 velocity = memory_.base_velocity[at(age + 1)];
  return ramp_.follow(followed_command(age), dt_, velocity);
}

const Observation& Predictor::predict(const Observation& o) noexcept {
  PredictionMemory& m = memory_;
  miss_steps(o.time);
  if (params_.identify) identify(o);
  if (base_dof_ > 0) correct_velocity(o);
  copy_observation(o, out_);
  out_.time += late_ * dt_;
  predict_joints();
  if (base_dof_ > 0) {
    if (m.begun) {
      move(*model_, m.base, mean_velocity(m.base_trip.periods), dt_);
      correct_base(o.base);
    } else {
      m.base = o.base;
      m.begun = true;
    }
    predict_base();
  }
  predict_velocity();
  for (std::size_t i = 0; i < o.objects.size(); ++i) predict_object(o.objects[i], i);
  object_memory_.look(o, std::span(out_.objects).first(o.objects.size()), m.objects);
  filter_.measure(o.goal.X_WG, o.goal.V_WG_W, m.goal);
  out_.goal.X_WG = m.goal.X_W();
  out_.goal.V_WG_W.setZero();
  if (m.goal.moving) {
    out_.goal.V_WG_W = m.goal.V_W;
    advance(m.goal.V_W, (goal_age_ + late_) * dt_, out_.goal.X_WG);
  }
  return out_;
}

void Predictor::miss_steps(double time) noexcept {
  PredictionMemory& m = memory_;
  const double since = std::exchange(m.time, time);
  const double most = static_cast<double>(periods_);  // after a long gap only the command sent last is remembered
  const double missed = since < 0.0 ? 0.0 : std::clamp(std::round((time - since) / dt_) - 1.0, 0.0, most);
  missed_ = static_cast<int>(missed);
  for (int k = 0; k < missed_; ++k) {
    skip();
    repeat(m.computed);
    repeat(m.sent);
    follow_command();
  }
  if (missed > 0.0) m.time = time;  // skip() advanced it
  if (missed >= most) m.begun = false;
  m.hold = std::max(1.0 + missed, 1.0 + (m.hold - 1.0) * std::exp(-dt_ / params_.estimation.missed));
  // A mean over the time since the start, later over the last seconds. One pause does not decide.
  constexpr double kLeastSpan = 0.2, kMostWeight = 0.2;
  const double span = std::clamp(time, kLeastSpan * params_.estimation.missed, params_.estimation.missed);
  m.kept += std::min(kMostWeight, (1.0 + missed) * dt_ / span) * (1.0 / (1.0 + missed) - m.kept);
}

void Predictor::predict_object(const ObjectState& seen, std::size_t i) noexcept {
  PoseTrack& track = memory_.objects[i];
  ObjectState& object = out_.objects[i];
  const double lateness = (object_age_ + late_) * dt_;
  if (seen.visible) {
    filter_.measure(seen.X_WO, seen.V_WO_W, track, seen.covariance ? &*seen.covariance : nullptr);
  } else if (object_memory_.believes(track) ||
             (uncertainty_.on() && track.seen > 0 && track.unseen + dt_ <= uncertain_.keep)) {
    filter_.coast(track);
    object.visible = true;
  } else {
    track = PoseTrack{};
    return;
  }
  object.X_WO = track.X_W();
  object.V_WO_W.setZero();
  if (track.moving) {
    object.V_WO_W = track.V_W;
    advance(track.V_W, lateness, object.X_WO);
  }
  if (uncertainty_.on()) spreads_[i] = uncertainty_.spread(track, lateness);
}

void Predictor::correct_base(const Vector3& measured) noexcept {
  Vector3& base = memory_.base;
  Vector3 innovation = measured - base;
  innovation.z() = std::remainder(innovation.z(), 2.0 * std::numbers::pi);  // headings may be wrapped or not
  const double relocated = params_.estimation.relocated;
  if (!(innovation.head<2>().norm() < relocated && std::abs(innovation.z()) < relocated)) {
    base = measured;
    return;
  }
  base += (params_.base_filter > dt_ ? dt_ / params_.base_filter : 1.0) * innovation;
}

// Observer of the base's velocity. A drive that slips, or is slower than the robot file states, lags behind its
// commands. The ramp moves towards the measured velocity, so that the next commands begin there.
void Predictor::correct_velocity(const Observation& o) noexcept {
  const EstimationParams& e = params_.estimation;
  PredictionMemory& m = memory_;
  const int now = m.base_trip.periods;
  const Vector3 command = followed_command(now);
  for (int i = 0; i < base_dof_; ++i) {
    const double ramp = m.base_velocity[at(now)][i];
    const double off = o.qdot[i] - ramp;
    const double change = e.observe * (off - std::clamp(off, -e.velocity_noise, e.velocity_noise));
    if (params_.identify) identify_slip(i, command[i], ramp + change);
    if (change == 0.0) continue;
    for (int age = 0; age <= now; ++age) m.base_velocity[at(age)][i] += change;
  }
}

// Estimates how much of a hard acceleration that it is asked for the base does, by the ramp and its correction. Gentle
// acceleration tells nothing of hard braking, hard speeding up does: it is the same drive on the same floor. A base
// that does not change its velocity at all has another gain, and does not slip.
void Predictor::identify_slip(int i, double command, double corrected) noexcept {
  PredictionMemory& m = memory_;
  const double kept = 1.0 - std::min(1.0, dt_ / params_.estimation.forget);
  m.asked[i] *= kept;
  m.behind[i] *= kept;
  const double before = m.base_velocity[at(m.base_trip.periods + 1)][i], most = ramp_.acceleration(i) * dt_;
  const double wanted = command - before;
  const double asked = std::min(std::abs(wanted), most), done = std::copysign(1.0, wanted) * (corrected - before);
  if (asked < kHard * most || done < kLeastDone * most) return;
  m.asked[i] += asked;
  m.behind[i] += asked - done;
  if (slip(i) > params_.estimation.slips) m.slowing = std::min(m.slowing, std::max(kLeastDone, 1.0 - slip(i)));
}

// Share of a hard acceleration that the base did not do of late.
double Predictor::slip(int i) const noexcept {
  return memory_.behind[i] / (memory_.asked[i] + params_.estimation.slip_prior * ramp_.acceleration(i));
}

// True if the base did clearly less than its drive does.
bool Predictor::slips() const noexcept {
  const double slow = 1.0 - kDrives[at(memory_.drive)].slowing;
  for (int i = 0; i < base_dof_; ++i)
    if (slip(i) > slow + params_.estimation.slips) return true;
  return false;
}

void Predictor::predict_joints() noexcept {
  const PredictionMemory& m = memory_;
  for (int age = m.joint_trip.periods - 1; age >= 0; --age) out_.q += dt_ * m.sent[at(age)].tail(num_joints_);
  for (int age = hold_joints_ - 1; age >= 0; --age) out_.q += dt_ * m.computed[at(age)].tail(num_joints_);
}

void Predictor::predict_base() noexcept {
  const PredictionMemory& m = memory_;
  out_.base = m.base;
  for (int age = m.base_trip.periods - 1; age >= 0; --age) move(*model_, out_.base, mean_velocity(age), dt_);
  Vector3 velocity = m.base_velocity.front();
  for (int age = hold_base_ - 1; age >= 0; --age)
    move(*model_, out_.base, ramp_.follow(ramp_.base_of(m.computed[at(age)]), dt_, velocity), dt_);
}

void Predictor::predict_velocity() noexcept {
  const PredictionMemory& m = memory_;
  Vector3 velocity = m.base_velocity.front();
  for (int age = hold_base_ - 1; age >= 0; --age) ramp_.follow(ramp_.base_of(m.computed[at(age)]), dt_, velocity);
  out_.qdot = m.computed.front();
  ramp_.set_base(velocity, out_.qdot);
}

void Predictor::skip() noexcept {
  PredictionMemory& m = memory_;
  if (m.time >= 0.0) m.time += dt_;
  if (m.begun) move(*model_, m.base, mean_velocity(m.base_trip.periods), dt_);
  predict_velocity();
  for (PoseTrack& track : m.objects) filter_.coast(track);
  filter_.coast(m.goal);
}

void Predictor::send(const VectorX& command, VectorX& sent) noexcept {
  PredictionMemory& m = memory_;
  shifted(m.computed) = command;
  for (int i = 0; i < base_dof_ + num_joints_; ++i)
    sent[i] = m.computed[at(i < base_dof_ ? hold_base_ : hold_joints_)][i];
  Vector3 base = ramp_.base_of(sent);
  if (gain_prior_ > 0.0) base = base.cwiseQuotient(gains()).cwiseMax(-base_speed_).cwiseMin(base_speed_);
  if (base_share_ > 0.0) base = ramp_.limited(base, ramp_.base_of(m.sent.front()), base_share_, dt_);
  ramp_.set_base(base, sent);
  // After a shorter wait commands are skipped: joints make the skipped changes as fast as their limits allow.
  if (m.catching_up) {
    m.catching_up = false;
    for (int i = 0; i < num_joints_; ++i) {
      double& u = sent[base_dof_ + i];
      const double now = m.sent.front()[base_dof_ + i], wanted = u;
      u = std::min(std::max(u, now - joint_step_[i]), now + joint_step_[i]);
      if (u != wanted) m.catching_up = true;
    }
  }
  shifted(m.sent) = sent;
  follow_command();
}

std::string prediction_mismatch(const PredictionMemory& memory, const RobotModel& model, const ControllerParams& params,
                                double control_period, std::size_t objects) {
  Predictor fresh(model, params.prediction, params.uncertainty, params.base_share, control_period);
  fresh.reset(std::vector<ObjectShape>(objects));
  const PredictionMemory& wanted = fresh.memory();
  std::string wrong;
  const auto count = [&wrong](std::string_view key, const auto& found, const auto& expected) {
    if (wrong.empty() && found.size() != expected.size())
      wrong = std::string(key) + " has " + std::to_string(found.size()) + " entries, expected " +
              std::to_string(expected.size()) + " for this robot, controller and objects";
  };
  const auto index = [&wrong](std::string_view key, int found, auto last) {
    if (wrong.empty() && !(found >= 0 && found <= static_cast<int>(last)))
      wrong = std::string(key) + " is " + std::to_string(found) + ", expected 0 to " + std::to_string(last);
  };
  count("computed", memory.computed, wanted.computed);
  count("sent", memory.sent, wanted.sent);
  count("base_velocity", memory.base_velocity, wanted.base_velocity);
  count("driven", memory.driven, wanted.driven);
  index("drive", memory.drive, kNumDrives - 1);
  count("objects", memory.objects, wanted.objects);
  for (const auto* commands : {&memory.computed, &memory.sent})
    for (const VectorX& u : *commands) count("each command", u, wanted.sent.front());
  for (const auto trip : {&PredictionMemory::base_trip, &PredictionMemory::joint_trip}) {
    count("misfit", (memory.*trip).misfit, (wanted.*trip).misfit);
    index("periods", (memory.*trip).periods, wanted.joint_trip.misfit.size() - 1);
  }
  return wrong;
}

}  // namespace moma
