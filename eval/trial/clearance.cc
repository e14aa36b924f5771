#include "eval/trial/clearance.h"

#include <algorithm>
#include <cmath>

#include "controller/safe/uncertainty.h"

namespace moma {
namespace {

constexpr double kAnything = 1e6;  // [m]
constexpr double kBeyond = 3.0;    // [m]

double reaction_of(const TrialSpec& spec) {
  const Disturbances& d = spec.disturbances;
  const double period = spec.simulation.control_period;
  const long drives =
      std::max(delay_steps(d.actuators.base.delay, period), delay_steps(d.actuators.joints.delay, period));
  return period * static_cast<double>(1 + delay_steps(d.objects.delay, period) + drives);
}

}  // namespace

void ClearanceWatch::look(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> objects) {
  // Only what is nearer than the least distance so far can change it.
  const auto range = [](double least) { return std::isnan(least) ? kAnything : std::max(least, 0.0); };
  for (const ProximityPair& pair :
       proximity.query(kinematics, objects, {range(to_objects_), -1.0, range(to_itself_)})) {
    double& least = pair.kind == PairKind::kSelf ? to_itself_ : to_objects_;
    if (!(least <= pair.distance.d)) least = pair.distance.d;
  }
}

SeparationWatch::SeparationWatch(const TrialSpec& spec)
    : ramp_(*spec.robot->model), reaction_(reaction_of(spec)), J_(3, spec.robot->model->num_velocities()) {}

void SeparationWatch::look(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> objects,
                           const VectorX& qdot) {
  moving_.assign(objects.begin(), objects.end());
  bool any = false;
  for (ObjectState& object : moving_) {
    object.visible = !object.V_WO_W.isZero(0.0);
    any = any || object.visible;
  }
  if (!any) return;
  const double stopping = ramp_.stopping_time(ramp_.base_of(qdot), 1.0);
  const double range = kBeyond + (std::isnan(least_) ? kBeyond : std::max(least_, 0.0));
  for (const ProximityPair& pair : proximity.query(kinematics, moving_, {range, -1.0, -1.0})) {
    const Distance& distance = pair.distance;
    const ObjectState& object = moving_[static_cast<std::size_t>(pair.second)];
    kinematics.point_jacobian(kinematics.model().shape(pair.first).link, distance.p_first_W, J_);
    // d increases along n with the motion of the robot's point, and decreases with the object's.
    const double v_H = std::max(0.0, distance.n_W.dot(velocity_at(object, distance.p_second_W)));
    const double v_R = std::max(0.0, -distance.n_W.dot(J_ * qdot));
    const double margin = distance.d - (v_H * (reaction_ + stopping) + v_R * (reaction_ + 0.5 * stopping));
    if (!(least_ <= margin)) least_ = margin;
  }
}

}  // namespace moma
