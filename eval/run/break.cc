#include "eval/run/break.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "eval/run/evaluate.h"
#include "eval/suite/controller_entry.h"
#include "world/draws.h"
#include "world/world_json.h"

namespace moma::run {
namespace {

/// The search of one point and one family.
struct Breaker {
  const BreakRequest& request;
  const Suite& suite;
  const RareEvent& event;
  const Listener& listener;
  MovedTrials& trials;
  Broken& out;
  const std::size_t point;
  const std::string& family;
  /// Places in `out` of the failures of this point and family, by world, link and object.
  std::map<std::tuple<std::uint64_t, std::string, std::string>, std::size_t> known = {};

  void search() {
    const SuitePoint& at = suite.points[point];
    TrialParticles particles(at, point, family, event, trials, listener);
    look_nearby(particles.unmoved(0, request.crude));
    risk::split(request.splitting, particles);
    for (std::size_t i = 0; i < request.splitting.particles * request.splitting.replicates; ++i)
      look(particles.worlds()[i], particles.rows()[i], particles.worlds()[i].moves ? "splitting" : "crude");
    tell("splitting");
  }

  /// Runs crude trials, then repeats the nearest ones with other noise.
  void look_nearby(const std::vector<MovedWorld>& worlds) {
    const std::vector<TrialRow> rows = trials.rows(point, worlds, true);
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!look(worlds[i], rows[i], "crude")) near.push_back(i);
    tell("crude trials");
    if (!any(suite.points[point].disturbances)) return;
    std::ranges::stable_sort(near,
                             [&](std::size_t a, std::size_t b) { return event.score(rows[a]) > event.score(rows[b]); });
    near.resize(std::min(near.size(),
                         static_cast<std::size_t>(std::ceil(request.nearest * static_cast<double>(worlds.size())))));
    std::vector<MovedWorld> again;
    for (const std::size_t i : near)
      for (int k = 1; k <= request.noises; ++k) again.push_back({worlds[i].index, noise_drawn_again(k)});
    const std::vector<TrialRow> found = trials.rows(point, again, true);
    for (std::size_t i = 0; i < again.size(); ++i) look(again[i], found[i], "noise");
    tell("other noise");
  }

  /// Records the trial if it is a failure, and returns whether it is.
  bool look(const MovedWorld& world, const TrialRow& row, const char* by) {
    if (!event.happened(row)) return false;
    const auto [place, fresh] = known.try_emplace({world.index, row.link, row.object}, out.failures.size());
    if (!fresh) {
      ++out.failures[place->second].times;
      return true;
    }
    const SuitePoint& at = suite.points[point];
    out.failures.push_back({.point = point,
                            .family = family,
                            .world = at.worlds.make(at.robot->model, world.index, nullptr, world.moves),
                            .row = row,
                            .by = by});
    return true;
  }

  void tell(const char* by) const {
    listener.note(fmt::format("{}, {}: {} distinct failures after {}, {} trials", suite.points[point].controller,
                              family, known.size(), by, trials.counts().computed + trials.counts().reused));
  }
};

/// The suite in the found worlds, as NAME-found.
Suite found_suite(const Suite& suite, const std::vector<Failure>& failures) {
  Json resolved = suite.resolved;
  resolved["name"] = suite.name + "-found";
  resolved["trials"] = failures.size();
  resolved["samples"] = "failures";
  resolved["worlds"] = {{"frozen", Json::array()}};
  for (const Failure& failure : failures) resolved["worlds"]["frozen"].push_back(to_json(failure.world));
  if (resolved.contains("points"))
    for (auto& point : resolved["points"]) point.erase("worlds");
  return suite_from_resolved(resolved, Plugins::kOfStore);  // the suite has loaded its plugins
}

}  // namespace

Broken break_suite(const BreakRequest& request, const Suite& suite, const RareEvent& event, const Listener& listener) {
  check_drawn(suite, "break");
  Broken out;
  const auto work = [&](MovedTrials& trials) {
    for (std::size_t point = 0; point < suite.points.size(); ++point)
      for (const auto& [family, share] : suite.points[point].worlds.shares())
        Breaker{request, suite, event, listener, trials, out, point, family}.search();
    out.trials = trials.counts().computed + trials.counts().reused;
  };
  static_cast<Ended&>(out) = with_moved_trials(request, suite, event.level(), listener, work);
  const bool one_robot = std::ranges::all_of(
      suite.points, [&](const SuitePoint& point) { return point.robot == suite.points.front().robot; });
  if (out.end != End::kFinished || out.failures.empty() || request.file.empty() || !one_robot) return out;
  EvaluateRequest held;
  static_cast<Request&>(held) = request;
  held.cluster = nullptr;  // the ranks hold the suite with other worlds
  static_cast<Ended&>(out) = evaluate(held, found_suite(suite, out.failures), listener);
  return out;
}

}  // namespace moma::run
