#include "controller/map/gaze.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "controller/model/kinematics.h"

namespace moma {
namespace {

constexpr double kFirst = -10.0;   // time before a motion at which each view was looked at [s]
constexpr double kStill = 0.05;    // difference of angles up to which a gaze is the one that was wanted [rad]
constexpr double kLate = 1.0;      // time beyond that of a turn after which a head counts as stuck [s]
constexpr double kAgain = 10.0;    // time for which a view is left out that the head did not reach [s]
constexpr double kAnywhere = 1.0;  // worth of a view of nothing, so that all around is looked at now and then

Gaze half_a_view(const Sensor& sensor) {
  return {std::max(0.5 * sensor.field_of_view[0], 0.1), std::max(0.5 * sensor.field_of_view[1], 0.1)};
}

// Angles from one end of a range to the other, no more than `apart` from each other.
std::vector<double> angles(const std::array<double, 2>& range, double apart) {
  const int count = static_cast<int>(std::ceil((range[1] - range[0]) / apart));
  std::vector<double> out;
  for (int i = 0; i <= count; ++i) out.push_back(count == 0 ? range[0] : range[0] + (range[1] - range[0]) * i / count);
  return out;
}

// Gazes of a head, no more than half a field of view apart; of a sensor without a head the only one.
std::vector<Gaze> gazes(const Sensor& sensor) {
  const Gaze apart = half_a_view(sensor);
  std::vector<Gaze> out;
  for (const double pan : angles(sensor.head.pan, apart.pan))
    for (const double tilt : angles(sensor.head.tilt, apart.tilt)) out.push_back({pan, tilt});
  return out;
}

}  // namespace

bool in_view(const Sensor& sensor, const Vector3& p_C) noexcept {
  const double r = p_C.norm();
  return r <= sensor.range && std::abs(std::atan2(p_C.y(), p_C.x())) <= 0.5 * sensor.field_of_view[0] &&
         std::abs(std::asin(p_C.z() / std::max(r, 1e-9))) <= 0.5 * sensor.field_of_view[1];
}

bool looks_behind(const RobotModel& model) {
  const Vector3 behind_W(-1.0, 0.0, 0.5);
  Kinematics robot(std::shared_ptr<const RobotModel>(std::shared_ptr<void>(), &model));
  robot.place(Vector3::Zero(), model.ready);
  return std::ranges::any_of(model.sensors, [&](const MountedSensor& mounted) {
    return std::ranges::any_of(gazes(mounted.sensor), [&](const Gaze& gaze) {
      const Isometry X_WC = robot.X_WL(mounted.link) * mounted.turned(gaze);
      return in_view(mounted.sensor, X_WC.inverse(Eigen::Isometry) * behind_W);
    });
  });
}

GazeChoice::GazeChoice(const MountedSensor& mounted) : mounted_(&mounted) {
  const Sensor& s = mounted.sensor;
  if (!s.head.turns()) return;
  apart_ = half_a_view(s);
  for (const Gaze& gaze : gazes(s)) views_.push_back({gaze, kFirst});
}

void GazeChoice::saw(const Gaze& gaze, double time, const Isometry& X_WL, std::span<const Sight> sights) noexcept {
  for (View& view : views_)
    if (std::abs(view.gaze.pan - gaze.pan) <= 0.5 * apart_.pan &&
        std::abs(view.gaze.tilt - gaze.tilt) <= 0.5 * apart_.tilt)
      view.seen_at = time;
  if (std::abs(wanted_.pan - gaze.pan) > kStill || std::abs(wanted_.tilt - gaze.tilt) > kStill) {
    if (time <= due_) return;
    for (View& view : views_)
      if (view.gaze == wanted_) view.seen_at = time + kAgain;
  }
  const Sensor& s = mounted_->sensor;
  double best = -1.0;
  for (const View& view : views_) {
    const double turn = std::max(std::abs(view.gaze.pan - gaze.pan), std::abs(view.gaze.tilt - gaze.tilt));
    const double cost = turn / s.head.speed + 1.0 / s.rate;
    const double score = (kAnywhere + worth(view, X_WL, sights)) * (time - view.seen_at) / cost;
    if (score <= best) continue;
    best = score;
    wanted_ = view.gaze;
    due_ = time + cost + kLate;
  }
}

double GazeChoice::worth(const View& view, const Isometry& X_WL, std::span<const Sight> sights) const noexcept {
  const Isometry X_CW = (X_WL * mounted_->turned(view.gaze)).inverse(Eigen::Isometry);
  double sum = 0.0;
  for (const Sight& sight : sights)
    if (in_view(mounted_->sensor, X_CW * sight.p_W)) sum += sight.worth;
  return sum;
}

}  // namespace moma
