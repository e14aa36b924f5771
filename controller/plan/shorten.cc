#include "controller/plan/shorten.h"

#include <algorithm>
#include <utility>

namespace moma {
namespace {

constexpr double kApart = 0.1;                    // of the two times, at least [s]
constexpr double kGain = 0.05, kPullGain = 0.02;  // that is worth the checks, without pulls and with them [s]
constexpr double kHeadFor = 0.1;                  // way that is worth a heading of its own [m]
constexpr double kSame = 1e-9;                    // [s]

// Corners between which one or two others are pulled, any two corners, or any times.
enum class Ends { kNear, kCorners, kTimes };

std::pair<double, double> two_times(const EdgeList& edges, Ends ends, CountedDraws& draws) noexcept {
  if (ends == Ends::kTimes) {
    const double T = edges.time();
    const double a = draws.uniform(0.0, T), b = draws.uniform(0.0, T);
    return {std::min(a, b), std::max(a, b)};
  }
  const std::size_t i = draws.choice(edges.size());
  const std::size_t j =
      ends == Ends::kNear ? std::min(i + 1 + draws.choice(2), edges.size() - 1) : draws.choice(edges.size());
  double from = 0.0, to = 0.0;
  for (std::size_t l = 0; l < std::min(i, j); ++l) from += edges[l].time;
  for (std::size_t l = 0; l <= std::max(i, j); ++l) to += edges[l].time;
  return {from, to};
}

}  // namespace

bool try_shortcut(FreeSpace& space, double check_step, int index, bool pulls, CountedDraws& draws, EdgeList& edges,
                  EdgeList& work) noexcept {
  const MotionLimits& limits = space.limits();
  const int joints = limits.num_joints();
  const double T = edges.time();
  const bool pull = pulls && index % 2 == 1;
  const auto [from, to] = two_times(edges, pull ? Ends::kNear : index % 3 == 0 ? Ends::kCorners : Ends::kTimes, draws);
  // The joint that is pulled: all of them in half of the draws.
  const int joint = pull ? static_cast<int>(draws.choice(static_cast<std::size_t>(2 * joints))) : 0;
  const double part = pull ? std::min(1.0, draws.uniform(0.0, 1.5)) : 1.0;
  space.charge(1);
  if (to - from < kApart) return false;
  WholeConfiguration a, b;
  edges.at(limits, from, a);
  edges.at(limits, to, b);
  if (index % 2 == 0 && to < T - kSame)
    head_along(limits, a, kHeadFor, b);
  else
    b[2] = a[2] + wrapped(b[2] - a[2]);
  work.clear();
  double t = 0.0;
  std::size_t l = 0;
  for (; l < edges.size() && t + edges[l].time <= from + kSame; ++l) {
    work.push(edges[l]);
    t += edges[l].time;
  }
  const std::size_t first_new = work.size();
  bool fits = true;
  const auto add = [&](const WholeConfiguration& begin, const WholeConfiguration& end) {
    Edge edge;
    make_edge(limits, begin, end, edge);
    fits = work.push(edge) && fits;
  };
  if (l < edges.size() && from - t > 1e-6) add(edges[l].a, a);
  WholeConfiguration last = a;
  for (; l < edges.size() && t + edges[l].time <= to + kSame; ++l) {
    t += edges[l].time;
    if (!pull || t > to - kSame) continue;
    WholeConfiguration c = edges[l].b;
    const WholeConfiguration straight = a + (t - from) / (to - from) * (b - a);
    for (int i = 0; i < joints; ++i)
      if (joint >= joints || joint == i) c[3 + i] += part * (straight - c)[3 + i];
    add(last, c);
    last = c;
  }
  add(last, b);
  std::size_t last_new = work.size();
  if (l < edges.size()) {
    add(b, edges[l].b);
    last_new = work.size();
    for (++l; l < edges.size(); ++l) fits = work.push(edges[l]) && fits;
  }
  if (!fits || work.time() > T - (pulls ? kPullGain : kGain)) return false;
  for (std::size_t i = first_new; i < last_new; ++i)
    if (!space.free(work[i], check_step)) return false;
  edges.swap(work);
  return true;
}

}  // namespace moma
