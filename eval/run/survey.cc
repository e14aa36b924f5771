#include "eval/run/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "world/holding.h"

namespace moma::run {
namespace {

constexpr double kFar = 0.5;  // larger gaps do not matter [m]

std::string pair_text(const World& world, const RobotModel& model, const ProximityPair& pair) {
  const std::string second = pair.kind == PairKind::kObject  ? world.objects[static_cast<std::size_t>(pair.second)].name
                             : pair.kind == PairKind::kFloor ? "the floor"
                                                             : model.shape(pair.second).name;
  return fmt::format("world {}, {} and {}", world.index, model.shape(pair.first).name, second);
}

/// The goals whose gaps are in [low, high).
struct Within {
  Within(const WorldLook& look, double low, double high) {
    for (const WorldLook::Gap& gap : look.goals) {
      if (gap.d < low || !(gap.d < high)) continue;
      ++count;
      if (nearest == nullptr || gap.d < nearest->d) nearest = &gap;
    }
  }
  std::size_t count = 0;
  const WorldLook::Gap* nearest = nullptr;
};

/// True if rows of one of moma's controllers keep a distance from objects.
bool keeps(const SuitePoint& point) {
  return point.plugin == nullptr && point.controller_params.method == Method::kQp &&
         point.controller_params.collision.object.enabled;
}

}  // namespace

void look_at(const World& world, const std::shared_ptr<const RobotModel>& empty, WorldLook& look) {
  const std::shared_ptr<const RobotModel> model = robot_at_start(empty, world);
  const int held = model->carried ? model->carried->object : -1;
  bool holds = held >= 0;
  Kinematics kinematics(model);
  Proximity proximity(model);
  proximity.set_objects(object_shapes(world));
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);

  kinematics.update(world.start.base, world.start.q);
  const auto touching = proximity.query(kinematics, states, {0.0, 0.0, 0.0});
  if (!touching.empty() && look.in_touch++ == 0) look.first_touch = pair_text(world, *model, touching.front());

  // Moves the objects instead of the robot to put E at each goal, whatever the arm's configuration.
  ProximityPair nearest;
  nearest.distance.d = kFar;
  (void)proximity.place(kinematics);
  for (std::size_t goal = 0; goal <= world.further.size(); ++goal) {
    object_states(world, 0.0, states);
    const Isometry move = kinematics.X_WE() * goal_state(world, 0.0, goal).X_WG.inverse();
    for (ObjectState& state : states) state.X_WO = move * state.X_WO;
    for (const int shape : (holds ? model : empty)->hand_shapes()) {
      for (std::size_t k = 0; k < states.size(); ++k) {
        const int object = static_cast<int>(k);
        if (in_motion(states[k]) || object == held) continue;
        const auto distance = proximity.within(PairKind::kObject, shape, object, states, nearest.distance.d);
        if (distance) nearest = {PairKind::kObject, shape, object, *distance};
      }
    }
    holds = holds && goal_of(world, goal).leave.empty();
  }
  const bool near = nearest.distance.d < kFar;
  look.goals.push_back({near ? nearest.distance.d : kInfinity, near ? pair_text(world, *model, nearest) : ""});
}

namespace {

/// Returns a sentence, with counts, if the tool touches objects at goals, which no configuration then reaches.
std::vector<std::string> touching_goals(const WorldLook& look) {
  const Within within(look, -kInfinity, 0.0);
  if (within.count == 0) return {};
  return {
      fmt::format("at the goal of {} of {} worlds the tool touches an object: no configuration reaches it (deepest: "
                  "{:.1f} mm in {})",
                  within.count, look.goals.size(), -1e3 * within.nearest->d, within.nearest->where)};
}

/// Returns one sentence, with counts, per controller of `points` whose rows stop the robot farther from objects than
/// the tool is at goals in `look` without contact.
std::vector<std::string> goal_warnings(const std::vector<const SuitePoint*>& points, const WorldLook& look) {
  std::vector<std::string> out;
  std::set<std::pair<std::string, double>> seen;
  for (const SuitePoint* point : points) {
    if (!keeps(*point)) continue;
    const CollisionParams& collision = point->controller_params.collision;
    const double stop = collision.at_goal.enabled ? collision.at_goal.least : collision.object.stop;
    const Within within(look, 0.0, stop);
    if (within.count == 0 || !seen.emplace(point->controller, stop).second) continue;
    out.push_back(fmt::format(
        "controller {}: at the goal of {} of {} worlds the tool is nearer to an object than the {:.1f} mm that "
        "its rows keep there (nearest: {:.1f} mm in {})",
        point->controller, within.count, look.goals.size(), 1e3 * stop, 1e3 * within.nearest->d,
        within.nearest->where));
  }
  return out;
}

/// Returns one sentence, with counts, per size of the errors of measured objects that exceeds the tool's room at goals
/// in `look`. Contact is a matter of chance there, whatever the controller.
std::vector<std::string> unsure_goals(const std::vector<const SuitePoint*>& points, const WorldLook& look) {
  std::vector<std::string> out;
  std::set<double> seen;
  for (const SuitePoint* point : points) {
    if (point->disturbances.detection.seen_by == SeenBy::kDepth) continue;  // no object is told
    const PoseSensing& objects = point->disturbances.objects;
    const double error = std::hypot(objects.bias.position, objects.noise.position);
    const Within within(look, 0.0, error);
    if (within.count == 0 || !seen.insert(error).second) continue;
    out.push_back(fmt::format(
        "objects are measured with errors of {:.1f} mm (standard deviation of each coordinate): at the goal of {} of "
        "{} worlds the tool has less room (nearest: {:.1f} mm in {}), and contact is a matter of chance",
        1e3 * error, within.count, look.goals.size(), 1e3 * within.nearest->d, within.nearest->where));
  }
  return out;
}

constexpr std::uint64_t kEnoughFailures = 3;  // further worlds of the family would take long and fail as well

/// Processor time of this thread.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

void WorldSurvey::make_worlds(const std::vector<SuitePoint>& points, std::uint64_t count, std::uint64_t trials) {
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> drawn;
  groups_.clear();
  for (const SuitePoint& point : points) {
    const auto [it, first] = known.try_emplace(
        point.robot_digest + point.robot->model->name + point.worlds.to_json().dump(), groups_.size());
    if (first) {
      if (point.worlds.size() < 0) drawn.push_back(groups_.size());
      groups_.emplace_back();
    }
    groups_[it->second].points.push_back(&point);
  }
  for (std::size_t i = 0; i < drawn.size(); ++i)
    make_worlds(groups_[drawn[i]], std::min(trials, count * (i + 1) / drawn.size() - count * i / drawn.size()));
  for (Group& group : groups_) look_at_frozen(group, std::min(trials, count));
}

void WorldSurvey::make_worlds(Group& group, std::uint64_t count) {
  const SuitePoint& point = *group.points.front();
  for (std::uint64_t index = 0; index < count; ++index) {
    Tally& tally = tallies_[{point.robot->model->name, point.worlds.family_of(index)}];
    if (tally.failed >= kEnoughFailures) continue;
    const double start = processor_seconds();
    double seconds = 0.0;
    try {
      const World world = point.worlds.make(point.robot->model, index, &tally.log);
      seconds = processor_seconds() - start;
      look_at(world, point.robot->model, group.look);
    } catch (const GenerationError& error) {
      seconds = processor_seconds() - start;
      if (tally.failed++ == 0) failures_.emplace_back(error.what());
    }
    tally.seconds += seconds;
  }
}

void WorldSurvey::look_at_frozen(Group& group, std::uint64_t count) {
  const SuitePoint& point = *group.points.front();
  const auto size = static_cast<std::uint64_t>(std::max(0LL, point.worlds.size()));
  try {
    for (std::uint64_t index = 0; index < std::min(size, count); ++index)
      look_at(point.worlds.make(point.robot->model, index), point.robot->model, group.look);
  } catch (const GenerationError& error) {  // worlds of another robot
    failures_.emplace_back(error.what());
  }
}

std::vector<std::string> WorldSurvey::doubts() const {
  std::vector<std::string> out;
  for (const Group& group : groups_) {
    const WorldLook& look = group.look;
    const std::string robot = groups_.size() > 1 ? "robot " + group.points.front()->robot->model->name + ": " : "";
    if (look.in_touch > 0)
      out.push_back(fmt::format("{}{} of {} worlds start in contact, which counts as a collision (first: {})", robot,
                                look.in_touch, look.goals.size(), look.first_touch));
    for (const std::string& text : touching_goals(look)) out.push_back(robot + text);
    for (const std::string& text : goal_warnings(group.points, look)) out.push_back(robot + text);
    for (const std::string& text : unsure_goals(group.points, look)) out.push_back(robot + text);
  }
  return out;
}

void WorldSurvey::run(const SuitePoint& point, const BatchJob& job) {
  double start = 0.0;
  BatchOptions options;
  options.world = [&start](const SuitePoint& of, std::uint64_t index) {
    auto world = std::make_shared<const World>(of.worlds.make(of.robot->model, index));
    start = processor_seconds();
    return world;
  };
  const BatchResult result = compute_job(point, job, options);
  if (result.world == nullptr || result.output.row.outcome == Outcome::kError) return;
  const auto found = tallies_.find({point.robot->model->name, result.world->family});
  if (found == tallies_.end()) return;
  ++found->second.trials;
  found->second.trial_seconds += processor_seconds() - start;
}

TrialTime trial_time(const Suite& suite, double enough, WorldSurvey& survey) {
  const auto most = static_cast<std::size_t>(64.0 * std::max(1.0, enough));
  const auto start = std::chrono::steady_clock::now();
  const std::size_t all = static_cast<std::size_t>(suite.trials) * suite.points.size();
  double seconds = 0.0;
  std::size_t n = 0;
  while (n < std::min(all, most) && seconds < enough) {
    // The golden ratio spreads the first few worlds evenly, so that families occur as often as in the whole.
    const auto world = static_cast<std::uint64_t>(std::fmod(static_cast<double>(n) * 0.6180339887498949, 1.0) *
                                                  static_cast<double>(suite.trials));
    BatchJob job;
    job.point = n % suite.points.size();
    job.world = world;
    survey.run(suite.points[job.point], job);
    ++n;
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return {seconds / static_cast<double>(n), n};
}

std::map<std::string, std::uint64_t> family_counts(const Suite& suite) {
  std::map<std::string, std::uint64_t> counts;
  const std::uint64_t looked_at = std::min<std::uint64_t>(suite.trials, 100000);
  for (std::uint64_t i = 0; i < looked_at; ++i) ++counts[suite.points.front().worlds.family_of(i)];
  return counts;
}

}  // namespace moma::run
