#include "eval/search/confirm.h"

#include <algorithm>

#include "eval/search/random.h"

namespace moma::tune {
namespace {

constexpr double kApart = 0.02;  // nearer finalists count as one

// Moves `u` by `by`, or the other way if that would leave the unit interval: a gain at its bound has neighbours on one
// side only.
double moved(double u, double by) {
  const double there = u + by;
  return there < 0.0 || there > 1.0 ? u - by : there;
}

std::vector<Candidate> neighbours(const SearchSettings& settings, const Candidate& candidate, std::size_t rank,
                                  const Confirmation& fitted) {
  const std::vector<double> unit = to_unit(settings.variables, candidate);
  std::vector<Candidate> result;
  for (std::size_t k = 0; k < fitted.neighbours; ++k) {
    std::vector<double> other(unit.size());
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const std::uint64_t position =
          (static_cast<std::uint64_t>(rank) << 40) | (static_cast<std::uint64_t>(k / 2) << 20) | i;
      const double sign = uniform(settings.seed, SearchStream::kNeighbours, position) < 0.5 ? -1.0 : 1.0;
      other[i] = moved(unit[i], (k % 2 == 0 ? sign : -sign) * fitted.radius);
    }
    result.push_back(from_unit(settings.variables, other));
  }
  return result;
}

}  // namespace

std::uint64_t fit_confirmation(const SearchSettings& settings, Confirmation& fitted) {
  fitted = settings.confirmation;
  fitted.worlds = std::min(fitted.worlds, settings.confirm_worlds.size());
  const auto cost = [&] {
    return static_cast<std::uint64_t>(fitted.candidates * (fitted.worlds + fitted.neighbours * settings.worlds.size()));
  };
  const std::uint64_t most = settings.budget / 4;
  while (fitted.neighbours > 2 && cost() > most) fitted.neighbours /= 2;
  while (fitted.candidates > 2 && cost() > most) --fitted.candidates;
  if (cost() > most) fitted.neighbours = 0;
  if (cost() > most) fitted.candidates = 0;
  return cost();
}

std::vector<Evaluation> best_of(const std::vector<Variable>& variables, const std::deque<Evaluation>& history,
                                std::size_t count, double apart) {
  std::vector<const Evaluation*> full;
  for (const Evaluation& e : history) {
    const bool searching = e.phase == Phase::kStart || e.phase == Phase::kGlobal || e.phase == Phase::kLocal;
    if (searching && !e.cut) full.push_back(&e);
  }
  std::stable_sort(full.begin(), full.end(),
                   [](const Evaluation* a, const Evaluation* b) { return a->merit < b->merit; });
  std::vector<Evaluation> result;
  for (const Evaluation* e : full) {
    if (result.size() == count) break;
    const bool near = std::any_of(result.begin(), result.end(), [&](const Evaluation& other) {
      return distance(variables, e->candidate, other.candidate) < apart;
    });
    if (!near) result.push_back(*e);
  }
  return result;
}

std::vector<Finalist> confirm(const SearchSettings& settings, const Confirmation& fitted, Evaluator& evaluator) {
  std::vector<Finalist> finalists;
  const std::vector<Evaluation> best =
      best_of(settings.variables, evaluator.history(), std::max<std::size_t>(fitted.candidates, 1), kApart);
  for (std::size_t rank = 0; rank < best.size(); ++rank) {
    Finalist finalist;
    finalist.candidate = best[rank].candidate;
    finalist.search_merit = best[rank].merit;
    finalist.merit = best[rank].merit;
    finalist.worlds = best[rank].worlds;
    finalist.neighbours = best[rank].merit;
    if (fitted.candidates > 0) {
      const Evaluation more =
          evaluator.extend(finalist.candidate, settings.worlds.size() + fitted.worlds, Phase::kConfirm);
      finalist.merit = more.merit;
      finalist.worlds = more.worlds;
      double sum = 0.0;
      const std::vector<Candidate> around = neighbours(settings, finalist.candidate, rank, fitted);
      for (const Candidate& other : around) {
        sum += evaluator.extend(other, settings.worlds.size(), Phase::kNeighbour).merit;
      }
      if (!around.empty()) finalist.neighbours = sum / static_cast<double>(around.size());
    }
    finalist.robust = 0.5 * (finalist.merit + finalist.neighbours);
    finalists.push_back(std::move(finalist));
  }
  std::stable_sort(finalists.begin(), finalists.end(),
                   [](const Finalist& a, const Finalist& b) { return a.robust < b.robust; });
  return finalists;
}

}  // namespace moma::tune
