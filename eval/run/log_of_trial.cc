#include "eval/run/log_of_trial.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "controller/step.h"

namespace moma::run {
namespace {

struct Heard {
  std::vector<std::string> objects;
  std::vector<Observation> seen;
  std::vector<VectorX> commands;
};

/// Records the observations and commands of a controller.
class Listened final : public StepController {
 public:
  Listened(std::unique_ptr<StepController> controller, Heard& heard)
      : controller_(std::move(controller)), heard_(heard) {}

  void reset(std::span<const ObjectShape> objects) override {
    controller_->reset(objects);
    for (const ObjectShape& object : objects) heard_.objects.push_back(object.name);
  }
  void see(const DepthFrame& frame) noexcept override { controller_->see(frame); }
  Gaze gaze(int sensor) const noexcept override { return controller_->gaze(sensor); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    controller_->step(observation, result);
    heard_.seen.push_back(observation);
    heard_.commands.push_back(result.command);
  }
  void prepare(StepResult& result) const override { controller_->prepare(result); }
  std::string_view failure() const noexcept override { return controller_->failure(); }

 private:
  std::unique_ptr<StepController> controller_;
  Heard& heard_;
};

/// The measurement time of each row: `delay` before the row, but not before the first row.
std::vector<double> stamps(const std::vector<double>& time, double delay, const Irregularity& irregularity,
                           double period) {
  if (!is_off(irregularity)) return {};  // the arrival of single measurements is unknown
  const long late = delay_steps(delay, period);
  std::vector<double> out;
  for (const double t : time) out.push_back(static_cast<double>(std::max(0L, std::lround(t / period) - late)) * period);
  return out;
}

}  // namespace

identify::MotionLog log_of_trial(const TrialSpec& spec, const World& world, const TrialParts& parts) {
  Heard heard;
  TrialParts listening = parts;
  listening.controller = [&](const TrialSpec& p) {
    return std::make_unique<Listened>(parts.controller ? parts.controller(p) : usual_controller(p), heard);
  };
  const TrialOutput trial = run_trial(spec, world, listening);
  if (trial.row.outcome == Outcome::kError) throw std::runtime_error("the trial ends by an error: " + trial.row.reason);

  const RobotModel& model = *spec.robot->model;
  const Disturbances& disturbances = spec.disturbances;
  const double period = spec.simulation.control_period;
  const std::size_t rows = heard.seen.size();
  identify::MotionLog log;
  log.source = "trial";
  for (std::size_t k = 0; k < rows; ++k) log.time.push_back(heard.seen[k].time);
  const int base_dof = model.base_dof();
  const char* const kNames[] = {"base.vx", "base.vy", "base.omega"};
  for (int i = 0; i < base_dof; ++i) log.base.emplace_back().name = kNames[i + 1 == base_dof ? 2 : i];
  for (const ControlledJoint& joint : model.joints) {
    identify::Axis& axis = log.joints.emplace_back();
    axis.name = joint.name;
    axis.prismatic = joint.type == JointType::kPrismatic;
  }
  for (std::size_t k = 0; k < rows; ++k) {
    const Observation& o = heard.seen[k];
    for (int i = 0; i < model.num_velocities(); ++i) {
      identify::Axis& axis =
          i < base_dof ? log.base[static_cast<std::size_t>(i)] : log.joints[static_cast<std::size_t>(i - base_dof)];
      axis.command.push_back(heard.commands[k][i]);
      axis.velocity.push_back(o.qdot[i]);
      if (i >= base_dof) axis.position.push_back(o.q[i - base_dof]);
    }
    if (base_dof == 0) continue;
    log.base_x.push_back(o.base.x());
    log.base_y.push_back(o.base.y());
    log.base_heading.push_back(o.base.z());
  }
  if (base_dof > 0) log.base_stamp = stamps(log.time, disturbances.base.delay, disturbances.base.irregularity, period);
  log.joint_stamp = stamps(log.time, disturbances.joints.delay, disturbances.joints.irregularity, period);
  for (std::size_t j = 0; j < world.objects.size(); ++j) {
    if (!at_rest(world.objects[j].motion, 0.0)) continue;
    if (!std::ranges::all_of(heard.seen, [&](const Observation& o) { return o.objects[j].visible; })) continue;
    identify::LoggedObject& point = log.objects.emplace_back();
    point.name = heard.objects[j];
    for (const Observation& o : heard.seen) {
      const Vector3& p = o.objects[j].X_WO.translation();
      point.x.push_back(p.x());
      point.y.push_back(p.y());
      point.z.push_back(p.z());
    }
    point.stamp = stamps(log.time, disturbances.objects.delay, disturbances.objects.irregularity, period);
  }
  return log;
}

}  // namespace moma::run
