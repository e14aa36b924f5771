#include "eval/run/break.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "eval/run/risk.h"
#include "world/draws.h"

namespace moma::run {
namespace {

class Breaker {
 public:
  Breaker(const BreakRequest& request, const Suite& suite, const RareEvent& event, const Listener& listener,
          MovedTrials& trials, Broken& out)
      : request_(request), suite_(suite), event_(event), listener_(listener), trials_(trials), out_(out) {}

  void family(std::size_t point, const std::string& family) {
    point_ = point;
    family_ = family;
    known_.clear();
    const SuitePoint& at = suite_.points[point];
    TrialParticles particles(at, point, family, event_, trials_, listener_);
    look_nearby(particles.unmoved(0, request_.crude));
    risk::split(request_.splitting, particles);
    for (std::size_t i = 0; i < particles.rows().size(); ++i)
      look(particles.worlds()[i], particles.rows()[i], "splitting");
    tell("splitting");
  }

 private:
  /// Runs crude trials, then repeats the nearest ones with other noise.
  void look_nearby(const std::vector<MovedWorld>& worlds) {
    const std::vector<TrialRow> rows = trials_.rows(point_, worlds, true);
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!look(worlds[i], rows[i], "crude")) near.push_back(i);
    tell("crude trials");
    if (!any(suite_.points[point_].disturbances)) return;
    std::stable_sort(near.begin(), near.end(),
                     [&](std::size_t a, std::size_t b) { return event_.score(rows[a]) > event_.score(rows[b]); });
    near.resize(std::min(near.size(),
                         static_cast<std::size_t>(std::ceil(request_.nearest * static_cast<double>(worlds.size())))));
    std::vector<MovedWorld> again;
    for (const std::size_t i : near)
      for (int k = 1; k <= request_.noises; ++k) again.push_back({worlds[i].index, noise_drawn_again(k)});
    const std::vector<TrialRow> found = trials_.rows(point_, again, true);
    for (std::size_t i = 0; i < again.size(); ++i) look(again[i], found[i], "noise");
    tell("other noise");
  }

  /// Records the trial if it is a failure, and returns whether it is.
  bool look(const MovedWorld& world, const TrialRow& row, const char* by) {
    if (!event_.happened(row)) return false;
    const auto [place, fresh] = known_.try_emplace({world.index, row.link, row.object}, out_.failures.size());
    if (!fresh) {
      ++out_.failures[place->second].times;
      return true;
    }
    const SuitePoint& at = suite_.points[point_];
    out_.failures.push_back({.point = point_,
                             .family = family_,
                             .world = at.worlds.make(at.robot->model, world.index, nullptr, world.moves),
                             .row = row,
                             .by = by});
    return true;
  }

  void tell(const char* by) const {
    listener_.tell(listener_.note,
                   fmt::format("{}, {}: {} distinct failures after {}, {} trials", suite_.points[point_].controller,
                               family_, known_.size(), by, trials_.counts().computed + trials_.counts().reused));
  }

  const BreakRequest& request_;
  const Suite& suite_;
  const RareEvent& event_;
  const Listener& listener_;
  MovedTrials& trials_;
  Broken& out_;
  std::size_t point_ = 0;
  std::string family_;
  std::map<std::tuple<std::uint64_t, std::string, std::string>, std::size_t> known_;
};

}  // namespace

Broken break_suite(const BreakRequest& request, const Suite& suite, const RareEvent& event, const Listener& listener) {
  check_drawn(suite, "break");
  Broken out;
  const auto work = [&](MovedTrials& trials) {
    Breaker breaker(request, suite, event, listener, trials, out);
    for (std::size_t point = 0; point < suite.points.size(); ++point)
      for (const auto& [family, share] : suite.points[point].worlds.shares()) breaker.family(point, family);
    out.trials = trials.counts().computed + trials.counts().reused;
  };
  out.end = with_moved_trials(request, suite, listener, work, out.stopped);
  return out;
}

}  // namespace moma::run
