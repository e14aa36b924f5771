#include "eval/run/shrink.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "controller/config/json_node.h"
#include "controller/model/kinematics.h"
#include "eval/batch/trial_rows.h"
#include "eval/risk/shrink_set.h"
#include "eval/run/moved_trials.h"
#include "eval/run/store_file.h"
#include "world/holding.h"
#include "world/sensing/disturbances_file.h"

namespace moma::run {
namespace {

struct SmallerWorld {
  World world;
  Disturbances disturbances;
  double earliest = 0.0;  ///< earlier failures, and those after `latest`, count as different [s]
  double latest = std::numeric_limits<double>::infinity();
};

/// Returns the paths of a disturbance section's numbers: "/base/delay".
std::vector<std::string> numbers_of(const Json& section, const std::string& place = "") {
  std::vector<std::string> places;
  for (const auto& [key, value] : section.items()) {
    const std::string at = place + "/" + key;
    if (value.is_object()) {
      for (std::string& inner : numbers_of(value, at)) places.push_back(std::move(inner));
    } else if (value.is_number() && at != "/seed") {
      places.push_back(at);
    }
  }
  return places;
}

std::string name_of(std::string place) {
  std::replace(place.begin(), place.end(), '/', '.');
  return place.substr(1);
}

Json without(Json section, const std::string& place) {
  const Json::json_pointer at(place);
  section[at.parent_pointer()].erase(at.back());
  return section;
}

/// Rounds to multiples of `step`, a part of 1, in their shortest form: 0.3, not 0.30000000000000004; never -0.
double rounded(double value, double step) { return std::round(value / step) / std::round(1.0 / step) + 0.0; }

bool at_rest(const World& world) {
  for (std::size_t i = 0; i <= world.further.size(); ++i)
    if (!std::holds_alternative<StaticMotion>(goal_of(world, i).motion)) return false;
  return std::ranges::all_of(
      world.objects, [](const WorldObject& object) { return std::holds_alternative<StaticMotion>(object.motion); });
}

/// Calls move(position) of each goal at rest. False if there is none.
bool move_goals(World& world, const std::function<Vector3(const Vector3&)>& move) {
  bool any = false;
  const auto one = [&](WorldGoal& goal) {
    if (!std::holds_alternative<StaticMotion>(goal.motion)) return;
    set_pose(goal, move(goal.X_WG.translation()), goal.file_rotation);
    any = true;
  };
  one(world.goal);
  for (WorldGoal& goal : world.further) one(goal);
  return any;
}

/// Lets the hand hold only objects that exist, one at a time.
void mend_grips(World& world) {
  if (world.held && find_object(world, world.held->object) < 0) world.held.reset();
  std::string held = world.held ? world.held->object : "";
  const auto one = [&](WorldGoal& goal) {
    if (goal.leave != held) goal.leave.clear();
    if (!goal.leave.empty()) held.clear();
    if (!held.empty() || find_object(world, goal.take) < 0) goal.take.clear();
    held += goal.take;
  };
  one(world.goal);
  for (WorldGoal& goal : world.further) one(goal);
}

/// Budget of candidates that pass in their own noise and, tried in the others, are not accepted. Each one that is
/// accepted adds as many. A world that fails in one noise of eight hardly ever fails in another one.
constexpr int kTriesInVain = 4;

class Shrinker {
 public:
  Shrinker(const ShrinkRequest& request, const Listener& listener)
      : request_(request), listener_(listener), suites_(request.plugins) {}

  Shrunk execute() {
    const Replay replay = run::replay(request_.file, request_.trial, suites_);
    point_ = *replay.point;
    trial_ = replay.trial.row;
    if (trial_.outcome == Outcome::kSuccess || trial_.outcome == Outcome::kError)
      throw RunError(fmt::format("trial {} did not fail: it ended by {}", replay.trial.key.substr(0, 16),
                                 to_string(trial_.outcome)));
    if (!same(replay.output.row, {}))
      throw RunError(
          fmt::format("trial {} does not fail again as it is stored; moma replay --check shows how it differs",
                      replay.trial.key.substr(0, 16)));
    now_ = {replay.world, point_.disturbances};
    now_.world.time_bound = std::numeric_limits<double>::infinity();  // rows of candidates are compared without it
    now_.earliest = std::min(0.5, 0.5 * trial_.time_end_s);           // excludes failures by the start state
    now_.latest = 2.0 * trial_.time_end_s + 1.0;                      // saves the rest of the trials that pass
    own_ = now_.world.moves;
    for (std::size_t i = 0; i < now_.world.objects.size(); ++i)
      if (now_.world.objects[i].noise < 0) now_.world.objects[i].noise = static_cast<int>(i);
    out_.objects_before = now_.world.objects.size();
    try {
      least_ = std::clamp(failing(rows(), now_), 1, std::max(1, request_.noises / 2));
      drop_goals();
      shrink_objects(false);
      switch_off();
      bring_to_rest();
      start_later();
      bring_goal_near();
      round_numbers();
      switch_off();  // worlds of round numbers may need fewer of them
      shrink_objects(true);
    } catch (const Interrupted& why) {
      if (*why.what() != '\0') listener_.warning(why.what());
      out_.end = End::kStopped;  // the smallest world so far fails
    }
    finish();
    return std::move(out_);
  }

 private:
  bool same(const TrialRow& row, const SmallerWorld& candidate) const {
    return row.outcome == trial_.outcome && row.object == trial_.object && row.time_end_s >= candidate.earliest &&
           row.time_end_s <= candidate.latest;
  }

  int noises(const SmallerWorld& candidate) const { return any(candidate.disturbances) ? request_.noises : 1; }

  /// Returns the moves of noise `number`; 0 is the trial's own.
  std::shared_ptr<const Moves> drawn_by(int number) const { return number == 0 ? own_ : noise_drawn_again(number); }

  /// Returns the k-th noise for candidates: the own one first.
  int noise(int k) const { return k == 0 ? noise_ : k <= noise_ ? k - 1 : k; }

  using Last = std::function<bool(std::size_t candidate, const TrialRow&)>;
  /// Returns rows of candidates, noises from .. to - 1 of each, up to the `last` one: the same for any number of
  /// threads.
  std::vector<TrialRow> rows(std::span<const SmallerWorld> candidates, int from, int to, const Last& last) {
    std::vector<SuitePoint> points(candidates.size(), point_);
    std::vector<BatchJob> jobs;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      points[c].disturbances = candidates[c].disturbances;
      double& limit = points[c].simulation.time_limit;
      limit = std::min(limit, candidates[c].latest + 2.0 * points[c].simulation.control_period);
      for (int k = from; k < to; ++k) jobs.push_back({c, static_cast<std::uint64_t>(k), ""});
    }
    BatchOptions batch;
    batch.threads = threads_of(request_);
    batch.stop = request_.stop;
    batch.world = [&](const SuitePoint& point, std::uint64_t k) {
      auto world = std::make_shared<World>(candidates[static_cast<std::size_t>(&point - points.data())].world);
      world->moves = drawn_by(noise(static_cast<int>(k)));
      return world;
    };
    std::vector<TrialRow> out;
    bool ended = false;
    const BatchSummary summary = run_batch(points, jobs, batch, [&](const BatchJob& job, BatchResult&& result) {
      TrialRow& row = out.emplace_back(std::move(result.output.row));
      if (is_late(row)) throw Interrupted("real time ran out in a trial: " + row.reason);
      ended = last(job.point, row);
      return !ended;
    });
    if (summary.stopped && !ended) throw Interrupted("");
    out_.trials += out.size();
    return out;
  }

  std::vector<TrialRow> rows() {
    return rows({&now_, 1}, 0, noises(now_), [](std::size_t, const TrialRow&) { return false; });
  }

  /// Continues with the first candidate that fails in enough noises. Returns its number; nothing if all pass. A
  /// candidate's trials end with the verdict. `last`: other noises are tried whether or not this has paid.
  std::optional<std::size_t> take(std::span<const SmallerWorld> candidates, bool last = false) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const int all = noises(candidates[c]), enough = std::min(least_, all);
      int asked = 0, fails = 0, first = 0;
      if (all == 1 || (!last && in_vain_ >= kTriesInVain * (1 + rescued_))) {  // the own noise decides
        const auto left = candidates.subspan(c);
        const auto fails_there = [&](std::size_t i, const TrialRow& row) {
          fails = same(row, left[i]) ? 1 : 0;
          return fails == 1;
        };
        c += rows(left, 0, 1, fails_there).size() - 1;
        if (fails == 0) break;
        asked = 1;
      }
      const auto decided = [&] { return fails == enough || fails + all - asked < enough; };
      if (!decided()) {
        rows(candidates.subspan(c, 1), asked, all, [&](std::size_t, const TrialRow& row) {
          if (same(row, candidates[c]) && fails++ == 0) first = asked;
          ++asked;
          return decided();
        });
      }
      const bool found = fails == enough;
      if (fails == 0 || first > 0) ++(found ? rescued_ : in_vain_);
      if (!found) continue;
      noise_ = noise(first);
      now_ = candidates[c];
      return c;
    }
    return std::nullopt;
  }

  int failing(const std::vector<TrialRow>& rows, const SmallerWorld& candidate) const {
    return static_cast<int>(std::ranges::count_if(rows, [&](const TrialRow& row) { return same(row, candidate); }));
  }

  /// `last`: takes single objects away, with every noise asked.
  void shrink_objects(bool last) {
    const World whole = now_.world;
    const auto touched =
        std::ranges::find_if(whole.objects, [&](const WorldObject& object) { return object.name == trial_.object; });
    std::optional<std::size_t> needed;
    if (touched != whole.objects.end()) needed = static_cast<std::size_t>(touched - whole.objects.begin());
    const auto failing = [&](const std::vector<risk::Things>& sets) {
      std::vector<SmallerWorld> candidates;
      for (const risk::Things& set : sets) {
        SmallerWorld candidate = now_;
        candidate.world.objects.clear();
        for (const std::size_t i : set) candidate.world.objects.push_back(whole.objects[i]);
        mend_grips(candidate.world);
        candidates.push_back(std::move(candidate));
      }
      return take(candidates, last);
    };
    risk::shrink_set(whole.objects.size(), needed, failing, last);
    listener_.note(
        fmt::format("{} of {} objects, {} trials", now_.world.objects.size(), out_.objects_before, out_.trials));
  }

  void switch_off() {
    if (!any(now_.disturbances)) return;
    SmallerWorld off = now_;
    off.disturbances = {};
    if (take({&off, 1})) return;
    std::vector<std::string> names;
    const Json all = to_json(now_.disturbances);
    for (const auto& [group, values] : all.items())
      if (values.is_object()) names.push_back("/" + group);
    for (const std::string& name : names) switch_off(name);
    for (const std::string& name : numbers_of(to_json(now_.disturbances))) switch_off(name);
    listener_.note(
        fmt::format("{} disturbances left, {} trials", numbers_of(to_json(now_.disturbances)).size(), out_.trials));
  }

  void switch_off(const std::string& name) {
    SmallerWorld off = now_;
    try {
      off.disturbances = read_disturbances(
          config::node_from_json(without(to_json(now_.disturbances), name), "disturbances"), "disturbances");
    } catch (const config::ConfigError&) {
      return;  // another disturbance needs it
    }
    if (any(off.disturbances)) take({&off, 1});
  }

  /// Simplifies a candidate by `change` with the first of `steps` that still fails; false if it does not apply.
  void simplify(const char* what, const std::vector<double>& steps,
                const std::function<bool(SmallerWorld&, double)>& change) {
    std::vector<SmallerWorld> candidates;
    std::vector<double> used;
    for (const double step : steps) {
      SmallerWorld candidate = now_;
      if (!change(candidate, step)) continue;
      candidates.push_back(std::move(candidate));
      used.push_back(step);
    }
    if (candidates.empty()) return;
    if (const auto found = take(candidates)) out_.changed.push_back(fmt::format(fmt::runtime(what), used[*found]));
  }

  void drop_goals() {
    for (std::size_t before = now_.world.further.size(); before > 0;) {
      std::vector<double> numbers;
      for (std::size_t i = 0; i <= before; ++i) numbers.push_back(static_cast<double>(i + 1));
      simplify("without goal {:g}", numbers, [](SmallerWorld& candidate, double number) {
        World& world = candidate.world;
        const auto at = static_cast<std::ptrdiff_t>(number) - 1;
        if (at == 0) world.goal = world.further.front();
        world.further.erase(world.further.begin() + std::max<std::ptrdiff_t>(0, at - 1));
        (world.further.empty() ? world.goal : world.further.back()).stop = true;
        mend_grips(world);
        return true;
      });
      before = now_.world.further.size() < before ? now_.world.further.size() : 0;
    }
  }

  void bring_to_rest() {
    simplify("everything at rest", {0.0}, [](SmallerWorld& candidate, double) {
      World& world = candidate.world;
      if (at_rest(world)) return false;
      for (WorldObject& object : world.objects) object.motion = StaticMotion{};
      world.goal.motion = StaticMotion{};
      for (WorldGoal& goal : world.further) goal.motion = StaticMotion{};
      return true;
    });
  }

  void start_later() {
    if (!at_rest(now_.world)) return;  // otherwise all motions would have to be advanced
    World own = now_.world;
    own.moves = drawn_by(noise_);
    SuitePoint point = point_;
    point.disturbances = now_.disturbances;
    const TrialOutput output = run_trial(point, own);
    ++out_.trials;
    simplify("starts {:g} s before", {1.0, 2.0, 4.0}, [&](SmallerWorld& candidate, double before) {
      const double from = output.row.time_end_s - before;
      const auto sample = std::ranges::find_if(output.trace, [&](const Sample& s) { return s.t >= from; });
      if (from <= 0.0 || sample == output.trace.end()) return false;
      start_from(candidate.world, {sample->base, sample->q}, point_.robot->model);
      // Excludes worlds that start in contact, or with a failure of a motion that starts there.
      candidate.earliest = 0.5 * before;
      candidate.latest = 2.0 * before;
      return true;
    });
  }

  void bring_goal_near() {
    Kinematics kinematics(point_.robot->model);
    kinematics.update(now_.world.start.base, now_.world.start.q);
    const Vector3 tip = kinematics.X_WE().translation();
    simplify("goal at {:g} of its distance", {0.25, 0.5, 0.75}, [&](SmallerWorld& candidate, double part) {
      return move_goals(candidate.world, [&](const Vector3& goal) { return Vector3(tip + part * (goal - tip)); });
    });
  }

  void round_numbers() {
    simplify("objects upright", {0.0}, [](SmallerWorld& candidate, double) {
      World& world = candidate.world;
      bool any = false;
      for (WorldObject& object : world.objects) {
        if (!std::holds_alternative<StaticMotion>(object.motion) || object.X_WO.linear().isIdentity(0.0)) continue;
        set_pose(object, object.X_WO.translation(), Eigen::Quaterniond::Identity());
        any = true;
      }
      return any;
    });
    simplify("objects to {:g} m", {0.1, 0.05, 0.01, 0.001}, [](SmallerWorld& candidate, double step) {
      World& world = candidate.world;
      for (WorldObject& object : world.objects) {
        for (double& size : object.shape.size) size = size > 0.0 ? std::max(rounded(size, step), step) : 0.0;
        if (!std::holds_alternative<StaticMotion>(object.motion)) continue;
        const Vector3 position = object.X_WO.translation().unaryExpr([&](double x) { return rounded(x, step); });
        set_pose(object, position, object.file_rotation);
      }
      return !world.objects.empty();
    });
    simplify("goal to {:g} m", {0.1, 0.05, 0.01, 0.001}, [](SmallerWorld& candidate, double step) {
      return move_goals(candidate.world, [&](const Vector3& goal) {
        return Vector3(goal.unaryExpr([&](double x) { return rounded(x, step); }));
      });
    });
    simplify("start to {:g}", {0.1, 0.05, 0.01, 0.001}, [this](SmallerWorld& candidate, double step) {
      Configuration start = candidate.world.start;
      for (double& x : start.base) x = rounded(x, step);
      for (double& x : start.q) x = rounded(x, step);
      start_from(candidate.world, start, point_.robot->model);
      return true;
    });
  }

  /// Counts the noises with a failure, and repeats the world's own trial.
  void finish() {
    const std::atomic<bool>* const stop = std::exchange(request_.stop, nullptr);
    now_.world.time_bound.reset();
    const std::vector<TrialRow> rows = this->rows();
    request_.stop = stop;
    out_.row = rows.front();
    out_.noises = static_cast<int>(rows.size());
    out_.failing = failing(rows, now_);
    out_.world = now_.world;
    out_.world.moves = any(now_.disturbances) ? drawn_by(noise_) : nullptr;
    Kinematics kinematics(point_.robot->model);
    kinematics.update(now_.world.start.base, now_.world.start.q);
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    out_.world.difficulty = {
        .goal_distance_m = (now_.world.goal.X_WG.translation() - kinematics.X_WE().translation()).norm(),
        .objects = static_cast<int>(now_.world.objects.size()),
        .witness_clearance_m = unknown,
        .narrowest_gap_m = unknown};
    if (any(now_.disturbances)) {
      out_.disturbances = to_json(now_.disturbances);
      for (const std::string& place : numbers_of(out_.disturbances)) out_.on.push_back(name_of(place));
    } else {
      out_.disturbances = Json::object();
    }
    std::string with =
        out_.on.empty() ? "no disturbance" : fmt::format("no disturbance but {}", fmt::join(out_.on, ", "));
    if (out_.on.size() > 6)
      with = fmt::format("{} of {} disturbances", out_.on.size(), numbers_of(to_json(point_.disturbances)).size());
    out_.sentence = fmt::format(
        "{}{}{} at {:.2f} s: fails in {} of {} noise{} with {} of {} objects and {}{}{}", to_string(trial_.outcome),
        out_.row.link.empty() ? "" : " of " + out_.row.link, trial_.object.empty() ? "" : " with " + trial_.object,
        out_.row.time_end_s, out_.failing, out_.noises, out_.noises == 1 ? "" : "s", now_.world.objects.size(),
        out_.objects_before, with, out_.changed.empty() ? "" : "; ", fmt::join(out_.changed, ", "));
  }

  ShrinkRequest request_;
  const Listener& listener_;
  StoredSuites suites_;
  SuitePoint point_;
  TrialRow trial_;    ///< as stored
  SmallerWorld now_;  ///< the smallest failing world so far
  std::shared_ptr<const Moves> own_;
  int noise_ = 0;                  ///< noise with which it fails
  int least_ = 1;                  ///< number of noises with which a candidate has to fail
  int in_vain_ = 0, rescued_ = 0;  ///< candidates that pass in the own noise; by verdict in the others: pass, fail
  Shrunk out_;
};

}  // namespace

Shrunk shrink(const ShrinkRequest& request, const Listener& listener) { return Shrinker(request, listener).execute(); }

}  // namespace moma::run
