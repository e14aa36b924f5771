#include "eval/tune/sensitivity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace moma::tune {
namespace {

constexpr std::size_t kFewestGlobal = 30;

Candidate moved(const std::vector<Variable>& variables, const Candidate& from,
                std::initializer_list<std::pair<std::size_t, double>> by) {
  std::vector<double> unit = to_unit(variables, from);
  for (const auto& [variable, step] : by) unit[variable] = std::clamp(unit[variable] + step, 0.0, 1.0);
  Candidate candidate = from;  // untouched gains keep their bits
  for (const auto& [variable, step] : by) candidate[variable] = from_unit(variables[variable], unit[variable]);
  return candidate;
}

struct MeanError {
  double mean = 0.0;
  double error = 0.0;
};

MeanError mean_error(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, values.size() > 1 ? std::sqrt(squares / (n - 1) / n) : 0.0};
}

// Mean ranks: equal merits share theirs.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && values[order[j]] == values[order[i]]) ++j;
    for (std::size_t k = i; k < j; ++k) result[order[k]] = 0.5 * static_cast<double>(i + j - 1);
    i = j;
  }
  return result;
}

double share(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  const auto bins = static_cast<std::size_t>(std::clamp(std::sqrt(static_cast<double>(n)), 2.0, 10.0));
  const double mean = std::accumulate(y.begin(), y.end(), 0.0) / static_cast<double>(n);
  const std::vector<double> position = ranks(x);  // equal values fall into one bin
  std::vector<double> sum(bins, 0.0), count(bins, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto bin =
        std::min(bins - 1, static_cast<std::size_t>(position[i] / static_cast<double>(n) * static_cast<double>(bins)));
    sum[bin] += y[i];
    count[bin] += 1.0;
    total += (y[i] - mean) * (y[i] - mean);
  }
  double between = 0.0;
  double used = 0.0;
  for (std::size_t b = 0; b < bins; ++b) {
    if (count[b] == 0.0) continue;
    const double d = sum[b] / count[b] - mean;
    between += count[b] * d * d;
    used += 1.0;
  }
  const double freedom = static_cast<double>(n) - used;
  if (total <= 0.0 || freedom <= 0.0) return 0.0;
  return std::max(0.0, (between - (used - 1.0) * (total - between) / freedom) / total);
}

}  // namespace

Sensitivity sensitivity(const SensitivitySettings& settings, const Candidate& found, Evaluator& evaluator) {
  Sensitivity result;
  if (!settings.enabled) return result;
  const std::vector<Variable>& variables = evaluator.settings().variables;
  const std::size_t worlds = evaluator.settings().search_worlds;
  const std::vector<double> base = evaluator.costs(found);
  const auto differences = [&](const Candidate& candidate, bool& valid) {
    valid = evaluator.extend(candidate, worlds, Phase::kSensitivity).valid;
    std::vector<double> d(worlds, 0.0);
    if (!valid) return d;
    const std::vector<double> costs = evaluator.costs(candidate);
    for (std::size_t w = 0; w < worlds; ++w) d[w] = costs[w] - base[w];
    return d;
  };

  std::vector<double> weight(variables.size(), 0.0);
  for (std::size_t i = 0; i < variables.size(); ++i) {
    for (const double step : {-settings.far, -settings.near, settings.near, settings.far}) {
      const Candidate candidate = moved(variables, found, {{i, step}});
      if (candidate == found) continue;  // at a bound
      SensitivityStep entry;
      entry.variable = i;
      entry.value = candidate[i];
      const MeanError change = mean_error(differences(candidate, entry.valid));
      entry.change = change.mean;
      entry.error = change.error;
      weight[i] = std::max(weight[i], std::abs(change.mean));
      result.steps.push_back(entry);
    }
  }

  std::vector<std::size_t> order(variables.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return weight[a] > weight[b]; });
  order.resize(std::min(order.size(), settings.pairs_of));
  std::sort(order.begin(), order.end());
  for (std::size_t a = 0; a < order.size(); ++a) {
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      std::vector<double> sum(worlds, 0.0);
      bool all_valid = true;
      for (const auto& [s, t] : {std::pair{1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}}) {
        bool valid = true;
        const std::vector<double> d =
            differences(moved(variables, found, {{order[a], s * settings.near}, {order[b], t * settings.near}}), valid);
        for (std::size_t w = 0; w < worlds; ++w) sum[w] += s * t * d[w] / 4.0;
        all_valid = all_valid && valid;
      }
      if (!all_valid) continue;
      const MeanError interaction = mean_error(sum);
      result.pairs.push_back({order[a], order[b], interaction.mean, interaction.error});
    }
  }
  return result;
}

std::vector<double> importance(const std::vector<Variable>& variables, const std::deque<Evaluation>& history) {
  std::vector<const Evaluation*> global, searched;
  for (const Evaluation& e : history) {
    if (!e.valid) continue;
    if (e.phase == Phase::kGlobal) global.push_back(&e);
    if (e.phase == Phase::kStart || e.phase == Phase::kGlobal || e.phase == Phase::kLocal) searched.push_back(&e);
  }
  const std::vector<const Evaluation*>& used = global.size() >= kFewestGlobal ? global : searched;
  std::vector<double> result(variables.size(), 0.0);
  if (used.size() < 4) return result;
  std::vector<double> merit;
  for (const Evaluation* e : used) merit.push_back(e->merit);
  const std::vector<double> y = ranks(merit);
  for (std::size_t i = 0; i < variables.size(); ++i) {
    std::vector<double> x;
    for (const Evaluation* e : used) x.push_back(e->candidate[i]);
    result[i] = share(x, y);
  }
  return result;
}

}  // namespace moma::tune
