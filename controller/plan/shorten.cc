#include "controller/plan/shorten.h"

#include <algorithm>
#include <utility>

namespace moma {
namespace {

constexpr double kApart = 0.1;    // of the two times, at least [s]
constexpr double kGain = 0.05;    // that is worth the checks [s]
constexpr double kHeadFor = 0.1;  // way that is worth a heading of its own [m]
constexpr double kSame = 1e-9;    // [s]

std::pair<double, double> two_times(const EdgeList& edges, bool corners, CountedDraws& draws) noexcept {
  if (!corners) {
    const double T = edges.time();
    const double a = draws.uniform(0.0, T), b = draws.uniform(0.0, T);
    return {std::min(a, b), std::max(a, b)};
  }
  const std::size_t i = draws.choice(edges.size()), j = draws.choice(edges.size());
  double from = 0.0, to = 0.0;
  for (std::size_t l = 0; l < std::min(i, j); ++l) from += edges[l].time;
  for (std::size_t l = 0; l <= std::max(i, j); ++l) to += edges[l].time;
  return {from, to};
}

}  // namespace

void try_shortcut(FreeSpace& space, double check_step, int index, CountedDraws& draws, EdgeList& edges,
                  EdgeList& work) noexcept {
  const MotionLimits& limits = space.limits();
  const double T = edges.time();
  const auto [from, to] = two_times(edges, index % 3 == 0, draws);
  space.charge(1);
  if (to - from < kApart) return;
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
  add(a, b);
  for (; l < edges.size() && t + edges[l].time <= to + kSame; ++l) t += edges[l].time;
  std::size_t last_new = work.size();
  if (l < edges.size()) {
    add(b, edges[l].b);
    last_new = work.size();
    for (++l; l < edges.size(); ++l) fits = work.push(edges[l]) && fits;
  }
  if (!fits || work.time() > T - kGain) return;
  for (std::size_t i = first_new; i < last_new; ++i)
    if (!space.free(work[i], check_step)) return;
  edges.swap(work);
}

}  // namespace moma
