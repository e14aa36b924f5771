#include "eval/search/evaluator.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "eval/search/random.h"
#include "eval/search/search.h"
#include "eval/stats/intervals.h"

namespace moma::tune {
namespace {

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

// Returns the scale of an excess over a bound.
double scale_of(double bound) { return std::max(std::abs(bound), 0.01); }

}  // namespace

Evaluator::Evaluator(const SearchSettings& settings, Objective& objective, EvaluationLog& log,
                     std::function<void(const Progress&)> progress)
    : settings_(settings), worlds_(settings.worlds), objective_(objective), log_(log), report_(std::move(progress)) {
  shuffle(worlds_, settings.seed, 0);
  std::vector<std::uint64_t> further = settings.confirm_worlds;
  shuffle(further, settings.seed, 1);
  worlds_.insert(worlds_.end(), further.begin(), further.end());
  if (objective_.width() != 1 + settings_.constraints.size()) {
    throw std::invalid_argument("the objective must give one cost and one value per constraint");
  }
  for (const Constraint& constraint : settings_.constraints) scales_.push_back(scale_of(constraint.at_most));
}

double Evaluator::violation(std::span<const double> means) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    sum += std::max(0.0, means[k] - settings_.constraints[k].at_most) / scales_[k];
  }
  return sum;
}

double Evaluator::above_start(std::size_t k, const std::vector<double>& values) const {
  if (history_.empty()) return 0.0;  // the start itself
  const std::vector<double>& start = known_.at(history_.front().candidate).values;
  const std::size_t width = objective_.width();
  const std::size_t worlds = std::min(values.size() / width, settings_.worlds.size());
  double sum = 0.0;
  for (std::size_t w = 0; w < worlds; ++w) sum += values[w * width + k + 1] - start[w * width + k + 1];
  return sum / static_cast<double>(worlds);
}

double Evaluator::penalised(const Evaluation& evaluation) const {
  const double penalty = penalty_ * violation(evaluation.constraints);
  double cost = evaluation.cost;
  for (std::size_t k = 0; k < settings_.constraints.size(); ++k)
    if (settings_.constraints[k].of_start && evaluation.constraints[k] > 0.0)
      cost = std::max(cost, history_.front().cost);
  return cost + penalty;
}

void Evaluator::summarise(Evaluation& evaluation, const std::vector<double>& values) {
  const std::size_t width = objective_.width();
  evaluation.worlds = values.size() / width;
  std::vector<double> sums(width, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) sums[i % width] += values[i];
  for (double& sum : sums) sum /= static_cast<double>(evaluation.worlds);
  evaluation.cost = sums[0];
  evaluation.constraints.assign(sums.begin() + 1, sums.end());
  for (std::size_t k = 0; k < settings_.constraints.size(); ++k) {
    if (!settings_.constraints[k].of_start) continue;
    if (history_.empty()) scales_[k] = scale_of(evaluation.constraints[k]);
    evaluation.constraints[k] = above_start(k, values);
  }
}

bool Evaluator::race_lost(const Known& known, std::size_t worlds) const {
  if (best_ < 0) return false;
  const Evaluation& incumbent = history_[static_cast<std::size_t>(best_)];
  // A lower cost proves nothing if the incumbent violates a constraint.
  if (violation(incumbent.constraints) > 0.0) return false;
  const std::vector<double>& other = known_.at(incumbent.candidate).values;
  const std::size_t width = objective_.width();
  std::vector<double> differences(worlds);
  double sum = 0.0;
  for (std::size_t w = 0; w < worlds; ++w) {
    differences[w] = known.values[w * width] - other[w * width];
    sum += differences[w];
  }
  return sum > 0.0 && stats::wilcoxon_greater(differences) < settings_.racing.significance;
}

std::optional<Evaluation> Evaluator::logged(const Evaluation& begun) {
  std::optional<Evaluation> stored = log_.find(begun.index);
  if (stored && (!same_bits(stored->candidate, begun.candidate) || stored->first != begun.first ||
                 stored->phase != begun.phase)) {
    throw ReplayError(
        fmt::format("stored evaluation {} has another candidate than the search: another version of moma or of NLopt "
                    "made it; give the search another seed, or use a new store",
                    begun.index));
  }
  return stored;
}

void Evaluator::take(Evaluation& evaluation, Known& known, std::size_t count, const std::optional<Evaluation>& stored) {
  const std::size_t width = objective_.width();
  const std::size_t have = known.values.size() / width;
  if (count <= have) return;
  std::vector<double> values;
  if (stored) {
    const std::size_t from = (have - evaluation.first) * width;
    const std::size_t to = (count - evaluation.first) * width;
    if (to > stored->measured.size()) {
      throw ReplayError(fmt::format(
          "stored evaluation {} ends after {} worlds, but the search continues: another version of moma made it",
          evaluation.index, stored->worlds));
    }
    values.assign(stored->measured.begin() + static_cast<std::ptrdiff_t>(from),
                  stored->measured.begin() + static_cast<std::ptrdiff_t>(to));
  } else {
    values = objective_.measure(evaluation.candidate, std::span(worlds_).subspan(have, count - have));
    if (values.size() != (count - have) * width) throw std::logic_error("objective gave a wrong number of values");
    for (const double value : values) {
      if (!std::isfinite(value)) throw std::runtime_error("the objective is not a finite number");
    }
  }
  known.values.insert(known.values.end(), values.begin(), values.end());
  evaluation.measured.insert(evaluation.measured.end(), values.begin(), values.end());
}

// Estimates cost and merit of a candidate that has not met all worlds.
void Evaluator::estimate(Evaluation& evaluation) const {
  if (!evaluation.valid) {
    for (const Evaluation& e : history_) evaluation.merit = std::max(evaluation.merit, e.merit);
    evaluation.cost = evaluation.merit;
    return;
  }
  const Evaluation& incumbent = history_[static_cast<std::size_t>(best_)];
  const std::vector<double>& other = known_.at(incumbent.candidate).values;
  double paired = 0.0;
  for (std::size_t w = 0; w < evaluation.worlds; ++w) paired += other[w * objective_.width()];
  evaluation.merit += incumbent.cost - paired / static_cast<double>(evaluation.worlds);
}

const Evaluation& Evaluator::conclude(Evaluation evaluation, Known& known, const Evaluation* stored) {
  if (stored != nullptr && !same_bits(stored->measured, evaluation.measured)) {
    throw ReplayError(
        fmt::format("stored evaluation {} has more worlds than the search needs: another version of moma made it",
                    evaluation.index));
  }
  if (evaluation.valid) {
    summarise(evaluation, known.values);
    if (history_.empty()) penalty_ = std::max(1.0, std::abs(evaluation.cost));
    evaluation.merit = penalised(evaluation);
  } else {
    evaluation.constraints.assign(settings_.constraints.size(), 0.0);
  }
  if (evaluation.cut) estimate(evaluation);
  trials_ += evaluation.measured.size() / objective_.width();
  if (evaluation.cut) ++cuts_;
  if (evaluation.cut && evaluation.valid) saved_ += settings_.worlds.size() - evaluation.worlds;
  known.latest = history_.size();
  history_.push_back(std::move(evaluation));
  const Evaluation& done = history_.back();
  if (done.searching() && !done.cut && (best_ < 0 || done.merit < history_[static_cast<std::size_t>(best_)].merit)) {
    best_ = static_cast<long long>(known.latest);
  }
  if (stored == nullptr) log_.append(done);
  if (report_) report_({done.phase, history_.size(), cuts_, trials_, settings_.budget, &done, best()});
  return done;
}

Evaluator::Begun Evaluator::begin(const Candidate& candidate, Phase phase, int run, std::size_t first) {
  Evaluation evaluation;
  evaluation.index = history_.size();
  evaluation.phase = phase;
  evaluation.run = run;
  evaluation.candidate = candidate;
  evaluation.first = first;
  std::optional<Evaluation> stored = logged(evaluation);
  evaluation.valid = objective_.valid(candidate);
  evaluation.cut = !evaluation.valid;
  return {std::move(evaluation), std::move(stored)};
}

const Evaluation& Evaluator::score(const Candidate& candidate, Phase phase, int run) {
  if (const auto found = known_.find(candidate); found != known_.end()) return history_[found->second.latest];
  auto [evaluation, stored] = begin(candidate, phase, run, 0);
  Known known;
  const Racing& racing = settings_.racing;
  const std::size_t full = settings_.worlds.size();
  if (evaluation.cut && history_.empty()) throw std::invalid_argument("the start values contradict each other");
  for (std::size_t worlds = racing.enabled ? std::min(racing.first, full) : full; !evaluation.cut;
       worlds = std::min(worlds + std::max<std::size_t>(racing.block, 1), full)) {
    take(evaluation, known, worlds, stored);
    if (worlds == full) break;
    evaluation.cut = race_lost(known, worlds);
  }
  Known& kept = known_.emplace(candidate, std::move(known)).first->second;
  return conclude(std::move(evaluation), kept, stored ? &*stored : nullptr);
}

const Evaluation& Evaluator::extend(const Candidate& candidate, std::size_t count, Phase phase) {
  count = std::min(count, worlds_.size());
  const auto found = known_.find(candidate);
  const std::size_t have = found == known_.end() ? 0 : found->second.values.size() / objective_.width();
  if (found != known_.end()) {
    const Evaluation& latest = history_[found->second.latest];
    if (have >= count || !latest.valid) return latest;
  }
  auto [evaluation, stored] = begin(candidate, phase, 0, have);
  Known& known = known_[candidate];
  if (evaluation.valid) take(evaluation, known, count, stored);
  return conclude(std::move(evaluation), known, stored ? &*stored : nullptr);
}

std::vector<double> Evaluator::costs(const Candidate& candidate) const {
  std::vector<double> result;
  const auto found = known_.find(candidate);
  if (found == known_.end()) return result;
  const std::size_t width = objective_.width();
  for (std::size_t i = 0; i < found->second.values.size(); i += width) result.push_back(found->second.values[i]);
  return result;
}

}  // namespace moma::tune
