#include "eval/search/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

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

/// Returns the largest cost of the confirmation in measurements within a quarter of the budget. Drops neighbours, then
/// candidates, until it fits, and stores the rest in `fitted` (0 candidates: no confirmation).
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

/// Returns the best fully measured candidates of the search that are at least `apart` from each other in some variable.
std::vector<Evaluation> best_of(const std::vector<Variable>& variables, const std::deque<Evaluation>& history,
                                std::size_t count, double apart) {
  std::vector<const Evaluation*> full;
  for (const Evaluation& e : history)
    if (e.searching() && !e.cut) full.push_back(&e);
  std::ranges::stable_sort(full, [](const Evaluation* a, const Evaluation* b) { return a->merit < b->merit; });
  std::vector<Evaluation> result;
  for (const Evaluation* e : full) {
    if (result.size() == count) break;
    const bool near = std::ranges::any_of(
        result, [&](const Evaluation& other) { return distance(variables, e->candidate, other.candidate) < apart; });
    if (!near) result.push_back(*e);
  }
  return result;
}

/// Measures the best few candidates of the history on further worlds, and their neighbours. Best first, never empty.
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
  std::ranges::stable_sort(finalists, [](const Finalist& a, const Finalist& b) { return a.robust < b.robust; });
  return finalists;
}

constexpr double kLocalApart = 0.1;  // least distance between the starts of local searches
constexpr double kAtBound = 0.01;    // share of a gain's range
// Ratio of the worlds of a full evaluation to those of a cut one, measured on the test problems. It only chooses a
// population that leaves a global algorithm time beyond its first points.
constexpr double kCheaper = 2.5;

class Searcher {
 public:
  Searcher(const SearchSettings& settings, Evaluator& evaluator, SearchResult& result)
      : settings_(settings),
        evaluator_(evaluator),
        result_(result),
        plan_(settings.plan.empty() ? default_plan() : settings.plan) {}

  void run(std::uint64_t limit) {
    const Candidate start = start_of(settings_.variables);
    evaluator_.score(start, Phase::kStart, 0);
    const std::uint64_t begin = evaluator_.trials();
    const auto starts = static_cast<std::uint64_t>(settings_.starts);
    for (std::uint64_t s = 0; s < starts; ++s) {
      const std::uint64_t to = begin + (limit - begin) / starts * (s + 1);
      run_plan(static_cast<int>(s), s + 1 == starts ? limit : to);
    }
  }

 private:
  bool affords(std::uint64_t limit) const { return evaluator_.trials() + settings_.worlds.size() <= limit; }

  std::vector<double> random_unit(std::uint64_t which) const {
    std::vector<double> unit(settings_.variables.size());
    for (std::size_t i = 0; i < unit.size(); ++i)
      unit[i] = uniform(settings_.seed, SearchStream::kStarts, (which << 20) | i);
    return unit;
  }

  void run_plan(int start, std::uint64_t limit) {
    const std::size_t first = start == 0 ? 0 : evaluator_.history().size();
    std::vector<double> origin = start == 0 ? to_unit(settings_.variables, start_of(settings_.variables))
                                            : random_unit(static_cast<std::uint64_t>(start));
    const std::uint64_t begin = evaluator_.trials();
    for (std::size_t i = 0; i < plan_.size(); ++i) {
      const AlgorithmInfo& algorithm = *plan_[i];
      const bool last = i + 1 == plan_.size();
      const std::uint64_t to = last ? limit : std::min(limit, evaluator_.trials() + (limit - begin) / 2);
      if (algorithm.global) {
        run_once(algorithm, start, origin, Phase::kGlobal, to);
      } else {
        run_local(algorithm, start, origin, first, to);
      }
    }
  }

  // From the best candidate of this start, then from the next best that is elsewhere, then from anywhere.
  void run_local(const AlgorithmInfo& algorithm, int start, const std::vector<double>& origin, std::size_t first,
                 std::uint64_t limit) {
    std::vector<Candidate> begun;
    for (std::uint64_t again = 0; affords(limit) && idle_ < 3; ++again) {
      std::vector<double> from = origin;
      const auto& history = evaluator_.history();
      const std::deque<Evaluation> own(history.begin() + static_cast<std::ptrdiff_t>(first), history.end());
      const std::vector<Evaluation> best = best_of(settings_.variables, own, begun.size() + 1, kLocalApart);
      const auto fresh = std::ranges::find_if(best, [&](const Evaluation& e) {
        return std::ranges::none_of(
            begun, [&](const Candidate& b) { return distance(settings_.variables, e.candidate, b) < kLocalApart; });
      });
      if (fresh != best.end()) {
        from = to_unit(settings_.variables, fresh->candidate);
      } else if (again > 0) {
        from = random_unit((static_cast<std::uint64_t>(start + 1) << 16) | again);
      }
      begun.push_back(from_unit(settings_.variables, from));
      run_once(algorithm, start, from, Phase::kLocal, limit);
    }
    idle_ = 0;
  }

  std::size_t population(const AlgorithmInfo& algorithm, std::uint64_t trials) const {
    if (!algorithm.has_population) return 0;
    const std::size_t n = settings_.variables.size();
    const double evaluations = kCheaper * static_cast<double>(trials) / static_cast<double>(settings_.worlds.size());
    return std::clamp(static_cast<std::size_t>(evaluations / 4), n + 2, 10 * (n + 1));
  }

  void run_once(const AlgorithmInfo& algorithm, int start, const std::vector<double>& from, Phase phase,
                std::uint64_t limit) {
    const std::uint64_t trials = evaluator_.trials();
    const std::size_t evaluations = evaluator_.history().size();
    const int number = static_cast<int>(result_.runs.size());
    NloptRun run;
    run.algorithm = &algorithm;
    run.start = from;
    run.seed = bits(settings_.seed, SearchStream::kNlopt, static_cast<std::uint64_t>(number)) >> 33;
    run.population = population(algorithm, limit > trials ? limit - trials : 0);

    NloptScores told;
    std::map<Candidate, double> heard;  // a repeated point gets its first answer
    std::size_t repeats = 0;
    const std::size_t most_repeats = 1000 + 100 * from.size();
    const std::string end = run_nlopt(run, [&](std::span<const double> unit) -> std::optional<double> {
      const Candidate candidate = from_unit(settings_.variables, unit);
      const std::size_t before = evaluator_.history().size();
      if (!evaluator_.knows(candidate) && !affords(limit)) return std::nullopt;
      const Evaluation& e = evaluator_.score(candidate, phase, number);
      // A search that meets only known points (few whole numbers, a degenerate simplex) would never end.
      repeats = evaluator_.history().size() > before ? 0 : repeats + 1;
      if (repeats > most_repeats) return std::nullopt;
      const auto known = heard.find(candidate);
      return known != heard.end() ? known->second : heard.emplace(candidate, told(e.merit, e.cut)).first->second;
    });
    RunNote note;
    note.algorithm = std::string(algorithm.name);
    note.start = start;
    note.trials = evaluator_.trials() - trials;
    note.evaluations = evaluator_.history().size() - evaluations;
    note.end = repeats > most_repeats ? "met nothing new" : end;
    idle_ = note.evaluations == 0 ? idle_ + 1 : 0;
    result_.runs.push_back(std::move(note));
  }

  const SearchSettings& settings_;
  Evaluator& evaluator_;
  SearchResult& result_;
  std::vector<const AlgorithmInfo*> plan_;
  int idle_ = 0;  // runs in a row that measured nothing
};

void check(const SearchSettings& s) {
  const auto fail = [](const std::string& message) { throw std::invalid_argument(message); };
  if (s.variables.empty()) fail("variables: name at least one key to search");
  for (const Variable& v : s.variables) check(v);
  if (s.worlds.empty()) fail("worlds: a search needs at least one");
  if (s.budget == 0) fail("budget.trials is 0: give the number of trials that the search may use");
  if (s.budget < 2 * s.worlds.size()) {
    fail(
        fmt::format("budget.trials {} does not reach for two candidates in {} worlds; raise it to {} or more, or use "
                    "fewer worlds",
                    s.budget, s.worlds.size(), 20 * s.worlds.size()));
  }
  if (s.starts < 1) fail("starts must be at least 1");
}

void add_notes(const SearchSettings& settings, const Confirmation& fitted, SearchResult& result) {
  const bool bounded =
      std::ranges::any_of(settings.constraints, [](const Constraint& constraint) { return !constraint.of_start; });
  if (bounded)
    result.notes.push_back(
        fmt::format("constraints by penalty: the cost grows by {:.4g} for an excess as large as the "
                    "bound itself",
                    result.penalty));
  if (fitted.candidates == 0) {
    result.notes.emplace_back(
        "the budget leaves no room to confirm the best candidates on other worlds: the best "
        "score of the search was taken");
  } else if (fitted.candidates < settings.confirmation.candidates ||
             fitted.neighbours < settings.confirmation.neighbours) {
    result.notes.push_back(fmt::format("confirmation was held to a quarter of the budget: {} candidates, {} neighbours",
                                       fitted.candidates, fitted.neighbours));
  }
  for (std::size_t i = 0; i < settings.variables.size(); ++i) {
    const Variable& v = settings.variables[i];
    const double u = to_unit(v, result.found[i]);
    if (u > kAtBound && u < 1.0 - kAtBound) continue;
    result.notes.push_back(fmt::format("{} = {} is at the {} bound of its range [{}, {}]: a wider range may do better",
                                       v.key, to_text(result.found[i]), u < 0.5 ? "lower" : "upper", v.lower, v.upper));
  }
}

}  // namespace

std::vector<const AlgorithmInfo*> default_plan() {
  return {&find_algorithm("GN_CRS2_LM"), &find_algorithm("LN_BOBYQA")};
}

SearchResult search(const SearchSettings& settings, Objective& objective, EvaluationLog& log,
                    const std::function<void(const Progress&)>& progress) {
  check(settings);
  Confirmation fitted;
  const std::uint64_t reserved = fit_confirmation(settings, fitted);
  Evaluator evaluator(settings, objective, log, progress);
  SearchResult result;
  Searcher(settings, evaluator, result).run(settings.budget - reserved);
  result.finalists = confirm(settings, fitted, evaluator);
  result.found = result.finalists.front().candidate;
  result.trials = evaluator.trials();
  result.sensitivity = sensitivity(settings.sensitivity, result.found, evaluator);
  result.importance = importance(settings.variables, evaluator.history());
  result.history = evaluator.history();
  result.trials_saved = evaluator.trials_saved();
  for (const Evaluation& e : result.history) result.evaluations_cut += e.cut ? 1 : 0;
  result.penalty = evaluator.penalty();
  add_notes(settings, fitted, result);
  return result;
}

}  // namespace moma::tune
