// Towards a goal that need not be stopped at: the path on to the next goal, and ways that pass the goal in motion.
#include <algorithm>
#include <cstdint>

#include "controller/lookahead/lookahead.h"
#include "controller/step_described.h"

namespace moma {

// Towards a goal that need not be stopped at, plans on to the next one: first from the end of the path, then for a way
// that passes the goal without a stop. True while there is work.
bool Lookahead::work_onward(const Observation& o, long& budget) noexcept {
  if (job_ == Job::kNone) {
    const bool may_pass = !state_.missed && !in_motion(o.goal) && !o.goal.stop && o.next && !in_motion(*o.next);
    if (!may_pass || !is_whole(o.goal) || !is_whole(*o.next) || state_.path.close() || traffic_) return false;
    if (state_.path.passes()) return begin_pass(o);
    if (state_.steps < state_.next_onward) return false;
    state_.next_onward = state_.steps + periods(params_.period);
    return begin_onward(o);
  }
  return job_ == Job::kPass ? work_pass(budget) : append_onward(budget);
}

// Begins a choice between ways from the end of the path to the next goal.
bool Lookahead::begin_onward(const Observation& o) noexcept {
  const Path& path = state_.path;
  MotionState end{path.origin, WholeConfiguration::Zero(path.origin.size())};
  path.at(path.duration, end.c);
  copy_observation(o, later_);
  choice_.put(shift_.of(end), later_);
  later_.goal = *o.next;
  later_.next.reset();
  choice_.begin(later_, -1.0, ++state_.brief.attempts);
  job_ = Job::kGoOn;
  return true;
}

// Makes the chosen way a part of the path.
bool Lookahead::append_onward(long& budget) noexcept {
  if (choice_.advance(budget)) return true;
  job_ = Job::kNone;
  Path on = choice_.path();
  if (choice_.verdict().kind != PlanKind::kPath || on.close()) return false;
  for (PathPart& part : on.parts()) part.change = shift_.turned_back(part.change);
  if (!state_.path.append(state_.brief.clock, on, shift_.back(later_.goal.X_WG))) return false;
  if (!choice_.is_direct()) state_.brief.reason = PlanReason::kQuicker;  // something may be quicker on the way
  state_.brief.duration = state_.path.duration;
  place_end();
  return true;
}

// Begins to look for a way that passes the goal, from where the path has the robot in a moment.
bool Lookahead::begin_pass(const Observation& o) noexcept {
  const Path& path = state_.path;
  const double ahead = state_.rate * params_.decisions.pass_ahead;
  if (params_.direct_way.pass_tries == 0 || ahead <= 0.0 || state_.brief.clock + ahead >= path.pass) return false;
  look_ahead_on_path(o, ahead);
  WholeConfiguration pass, last;
  path.at(path.pass, pass);
  path.at(path.duration, last);
  choice_.direct_way().begin_passing(choice_.motion_of(later_), o.goal.X_WG, o.next->X_WG, shift_.of(pass),
                                     shift_.of(last), path.duration - way_from_ - params_.decisions.way_gain,
                                     static_cast<std::uint64_t>(state_.steps), o.objects);
  job_ = Job::kPass;
  return true;
}

// Goes over to it if it is quicker than the path, goal and next goal together.
bool Lookahead::work_pass(long& budget) noexcept {
  DirectWay& way = choice_.direct_way();
  const double until = std::max(0.0, way_from_ - state_.brief.clock);
  if (way.advance(budget) && until > dt_) return true;
  job_ = Job::kNone;
  if (!way.found()) return false;
  state_.path = way.path();
  state_.path.begin_earlier(until);
  begin_path(PlanReason::kDirectWay);
  return true;
}

}  // namespace moma
