#include "world/sensing/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "world/sensing/delay_line.h"

namespace moma {
namespace {

// Sensors have draws of their own, beside those of objects of any number.
constexpr std::size_t kSensors = 1'000'000;

// Errors of two rays from two draws: a pair of normals (Box & Muller), and whether each is missing. A draw has bits for
// two numbers. Rays that meet nothing need no normals.
struct PairOfErrors {
  double normal[2]{};
  bool missing[2];

  PairOfErrors(Draws& draws, double share_missing, bool normals) {
    const auto [of_radius, of_angle] = two(draws.uniform());
    if (normals) {
      const double radius = std::sqrt(-2.0 * std::log(1.0 - of_radius));  // of a number in (0, 1]
      const double angle = 2.0 * std::numbers::pi * of_angle;
      normal[0] = radius * std::cos(angle);
      normal[1] = radius * std::sin(angle);
    }
    const auto [first, second] = two(draws.uniform());
    missing[0] = first < share_missing;
    missing[1] = second < share_missing;
  }

 private:
  static std::array<double, 2> two(double uniform) {
    const double both = uniform * 0x1p26, first = static_cast<double>(static_cast<long>(both));
    return {first * 0x1p-26, both - first};
  }
};

}  // namespace

DepthSensing::DepthSensing(const Disturbances& disturbances, const RobotModel& model, std::span<const Shape> objects,
                           const DisturbanceStreams& streams, double control_period)
    : errors_(disturbances.detection.ranges),
      irregularity_(disturbances.objects.irregularity),
      streams_(streams),
      dt_(control_period),
      delay_(delay_steps(disturbances.objects.delay, control_period)),
      jitter_(delay_steps(irregularity_.jitter, control_period)),
      robot_({std::shared_ptr<void>(), &model}),
      frames_(model, control_period),
      wanted_(model.sensors.size()),
      taken_(model.sensors.size(), 0) {
  frames_.set_objects(objects);
  for (int i = 0; i < frames_.count(); ++i) {
    const Sensor& sensor = model.sensors[static_cast<std::size_t>(i)].sensor;
    range_.push_back(sensor.range);
    const long every = std::max(1L, std::lround(frames_.interval(i) / dt_));
    Sent none;
    none.frame.sensor = i;
    none.frame.ranges = VectorX::Zero(sensor.columns * sensor.rows);
    sent_.emplace_back(static_cast<std::size_t>((delay_ + jitter_) / every + 2), none);
  }
}

void DepthSensing::sense(long k, const Vector3& base, const VectorX& q, std::span<const ObjectState> objects) {
  k_ = k;
  for (int i = 0; i < frames_.count(); ++i) frames_.turn(i, wanted_[static_cast<std::size_t>(i)]);
  bool any = false;
  for (int i = 0; i < frames_.count(); ++i) any = any || frames_.is_due(i, k);
  if (!any) return;
  robot_.place(base, q);
  frames_.look(k, robot_, objects);
  for (int i = 0; i < frames_.count(); ++i) {
    if (!frames_.due(i)) continue;
    const auto sensor = static_cast<std::size_t>(i);
    Sent& sent = sent_[sensor][taken_[sensor]++ % sent_[sensor].size()];
    sent.frame.time = static_cast<double>(k) * dt_;
    sent.frame.gaze = frames_.gaze(i);
    measure(frames_.view(i), streams_.sensing(DisturbanceSource::kDepthNoise, k, kSensors + sensor), sent.frame.ranges);
    const long more =
        is_off(irregularity_)
            ? 0
            : arrival(irregularity_, jitter_, streams_.sensing(DisturbanceSource::kDepthArrival, k, kSensors + sensor));
    sent.due = k == 0 ? 0 : more < 0 ? kNone : k + delay_ + more;
  }
}

void DepthSensing::measure(const RayView& view, Draws draws, VectorX& ranges) const {
  const Isometry& X_WC = view.pose();
  const double height = X_WC.translation().z();
  const Vector3 down_C = -X_WC.linear().row(2).transpose();
  for (Eigen::Index i = 0; i < ranges.size(); ++i) {
    double r = view.distances()[static_cast<std::size_t>(i)];
    const double falls = down_C.dot(view.directions_C()[static_cast<std::size_t>(i)]);
    if (falls > 0.0 && height > 0.0) r = std::min(r, height / falls);
    ranges[i] = r <= view.range() ? r : std::numeric_limits<double>::infinity();
  }
  if (is_off(errors_)) return;
  // As many draws for each ray, so that no ray's errors depend on what another one met.
  for (Eigen::Index i = 0; i < ranges.size(); i += 2) {
    const Eigen::Index both = std::min<Eigen::Index>(2, ranges.size() - i);
    const bool any = std::isfinite(ranges[i]) || std::isfinite(ranges[i + both - 1]);
    const PairOfErrors errors(draws, errors_.missing, any);
    for (Eigen::Index k = 0; k < both; ++k) {
      double& r = ranges[i + k];
      if (std::isfinite(r)) r = std::max(0.0, r + (errors_.noise + errors_.growth * r * r) * errors.normal[k]);
      if (errors.missing[k]) r = 0.0;
    }
  }
}

void DepthSensing::show(StepController& controller) {
  for (std::vector<Sent>& ring : sent_) {
    Sent* newest = nullptr;
    for (Sent& sent : ring) {
      if (sent.due == kNone || sent.due > k_) continue;
      if (newest != nullptr) (newest->frame.time < sent.frame.time ? newest->due : sent.due) = kNone;
      if (newest == nullptr || newest->frame.time < sent.frame.time) newest = &sent;
    }
    if (newest == nullptr) continue;
    newest->due = kNone;
    controller.see(newest->frame);
  }
  for (int i = 0; i < frames_.count(); ++i) wanted_[static_cast<std::size_t>(i)] = controller.gaze(i);
}

}  // namespace moma
