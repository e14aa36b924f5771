#include "eval/run/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "controller/config/json_node.h"
#include "controller/config/node.h"
#include "controller/config/text_file.h"
#include "controller/controller.h"
#include "eval/run/listener.h"
#include "eval/store/columns.h"
#include "eval/store/machine.h"
#include "world/sensing/detection.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma::run {

using store::StoreError;

const Suite& StoredSuites::suite_of(const store::StoredTrial& trial) {
  const auto found = suites_.find(trial.resolved_suite);
  if (found != suites_.end()) return found->second;
  Suite suite = suite_from_resolved(
      config::parse_json(trial.resolved_suite, fmt::format("the suite of trial {}", trial.key.substr(0, 16))),
      plugins_);
  return suites_.emplace(trial.resolved_suite, std::move(suite)).first->second;
}

const SuitePoint& StoredSuites::point_of(const store::StoredTrial& trial) {
  if (trial.simulation_version != kSimulationVersion) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("trial {} was simulated by version {} of the simulation, this program has version {}: "
                                 "it would not give the same result",
                                 trial.key.substr(0, 16), trial.simulation_version, kSimulationVersion));
  }
  const Suite& suite = suite_of(trial);
  if (trial.position >= suite.points.size()) {
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("trial {}: its suite has no point {}; the store is damaged", trial.key.substr(0, 16),
                                 trial.position));
  }
  return suite.points[trial.position];
}

World world_of(const store::StoredTrial& trial) {
  const auto json = config::parse_json(trial.world, fmt::format("world of trial {}", trial.key.substr(0, 16)));
  if (json.contains("missing")) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("trial {}: its world could not be made, so there is nothing to replay ({})",
                                 trial.key.substr(0, 16), trial.row.reason));
  }
  return world_from_json(json, fmt::format("world of trial {}", trial.key.substr(0, 16)));
}

Suite stored_suite(const fs::path& store, const std::string& name, const std::string& trials, Plugins plugins) {
  auto resolved = config::parse_json(store::Reader(store).latest_suite(name),
                                     fmt::format("{}: the resolved suite {}", store.string(), name));
  if (!trials.empty()) {
    // Read as in a suite: a number, or a map; the reader of `trials` rejects anything else.
    resolved["trials"] = config::node_to_json(config::parse_yaml(trials, "--trials " + config::shortened(trials)));
  }
  return suite_from_resolved(resolved, plugins);
}

Replay replay(const fs::path& store, const std::string& name, StoredSuites& suites, TrialRows* rows) {
  Replay replay;
  replay.trial = store::Reader(store).trial(name);
  replay.point = &suites.point_of(replay.trial);
  replay.world = world_of(replay.trial);
  replay.output =
      rows == nullptr ? run_trial(*replay.point, replay.world) : run_trial(*replay.point, replay.world, *rows);
  return replay;
}

ReplayDifferences differences(const TrialRow& stored, const std::string& machine_class, const TrialRow& replayed) {
  ReplayDifferences found{store::differences(stored, replayed), "", store::this_machine().machine_class};
  if (!machine_class.empty() && machine_class != found.this_machine) found.stored_machine = machine_class;
  return found;
}

ControlCase stored_case(StoredSuites& suites, const fs::path& file, const std::string& trial, long step) {
  const store::StoredTrial stored = store::Reader(file).trial(trial);
  try {
    return case_of_step(suites.point_of(stored), world_of(stored), step);
  } catch (const std::invalid_argument& e) {
    throw RunError(e.what());
  }
}

std::optional<double> known_before_contact(const CollisionCase& collision) {
  const World world = world_from_json(config::parse_json(collision.world, "world"), "world");
  const Disturbances disturbances =
      read_disturbances(config::parse_yaml(collision.disturbances, "disturbances"), "disturbances");
  const auto hit =
      std::ranges::find_if(world.objects, [&](const WorldObject& object) { return object.name == collision.object; });
  const DetectionRule& rule = disturbances.detection;
  if (rule.occlusion || rule.mount == SensorMount::kHand || rule.seen_by != SeenBy::kRule)
    return {};  // samples without a base do not contain the arm's motion
  Detection detection(rule, world, DisturbanceStreams(world, disturbances.seed), collision.control_period);
  if (hit == world.objects.end() || !detection.on()) return {};
  const auto place = static_cast<std::size_t>(hit - world.objects.begin());
  std::vector<ObjectState> states(world.objects.size());
  for (std::size_t k = 0; k < collision.t.size(); ++k) {
    const double* base = collision.base.data() + 3 * k;
    object_states(world, collision.t[k], states);
    for (ObjectState& state : states) state.visible = true;
    detection.update(static_cast<long>(k), {base[0], base[1], base[2]}, {}, states);
    if (!states[place].visible) continue;
    // An object known from the start has no detection time.
    const double since = k == 0 ? 0.0 : collision.t[k] + disturbances.objects.delay;
    return std::max(0.0, collision.contact_time - since);
  }
  return 0.0;
}

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

std::unique_ptr<StepController> usual(const TrialSpec& spec) {
  if (spec.plugin != nullptr) return spec.plugin->make();
  return std::make_unique<Controller>(spec.robot->model, told_params(spec), spec.simulation.control_period);
}

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
    return std::make_unique<Listened>(parts.controller ? parts.controller(p) : usual(p), heard);
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
