#include "eval/search/sensitivity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "eval/search/search.h"

namespace moma::tune {
namespace {

Candidate moved(const std::vector<Variable>& variables, const Candidate& from,
                std::initializer_list<std::pair<std::size_t, double>> by) {
  std::vector<double> unit = to_unit(variables, from);
  for (const auto& [variable, step] : by) unit[variable] = std::clamp(unit[variable] + step, 0.0, 1.0);
  Candidate candidate = from;  // unchanged gains keep their bits
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

// Mean ranks: equal merits share a rank.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && values[order[j]] == values[order[i]]) ++j;
    for (std::size_t k = i; k < j; ++k) result[order[k]] = 0.5 * static_cast<double>(i + j - 1);
    i = j;
  }
  return result;
}

// Columns: 1, then u - 1/2 and its square for each varying gain.
Eigen::MatrixXd quadratic_terms(const std::vector<Variable>& variables, const std::vector<const Evaluation*>& used) {
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd terms(n, 1 + 2 * static_cast<Eigen::Index>(variables.size()));
  terms.col(0).setOnes();
  for (Eigen::Index r = 0; r < n; ++r) {
    const std::vector<double> unit = to_unit(variables, used[static_cast<std::size_t>(r)]->candidate);
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const double d = unit[i] - 0.5;
      terms(r, 1 + 2 * static_cast<Eigen::Index>(i)) = d;
      terms(r, 2 + 2 * static_cast<Eigen::Index>(i)) = d * d;
    }
  }
  return terms;
}

}  // namespace

Sensitivity sensitivity(const SensitivitySettings& settings, const Candidate& found, Evaluator& evaluator) {
  Sensitivity result;
  if (!settings.enabled) return result;
  const std::vector<Variable>& variables = evaluator.settings().variables;
  const std::size_t worlds = evaluator.settings().worlds.size();
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
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return weight[a] > weight[b]; });
  order.resize(std::min(order.size(), settings.pairs_of));
  std::ranges::sort(order);
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
    if (e.searching()) searched.push_back(&e);
  }
  const std::size_t coefficients = 1 + 2 * variables.size();
  const std::vector<const Evaluation*>& used = global.size() >= 3 * coefficients ? global : searched;
  std::vector<double> result(variables.size(), std::numeric_limits<double>::quiet_NaN());
  if (used.size() < 3 * coefficients) return result;

  std::vector<double> merit;
  for (const Evaluation* e : used) merit.push_back(e->merit);
  const std::vector<double> rank = ranks(merit);
  const auto n = static_cast<double>(rank.size());
  Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(rank.data(), static_cast<Eigen::Index>(rank.size()));
  y.array() -= y.mean();
  const double total = y.squaredNorm();
  if (total <= 0.0) return result;
  const Eigen::MatrixXd terms = quadratic_terms(variables, used);
  const Eigen::VectorXd fit = terms.completeOrthogonalDecomposition().solve(y);
  const double residual = (y - terms * fit).squaredNorm();
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const Eigen::Index c = 1 + 2 * static_cast<Eigen::Index>(i);
    const Eigen::VectorXd part = terms.middleCols(c, 2) * fit.segment(c, 2);
    // y has mean zero, so that the mean of `part` does not matter.
    const double chance = 2.0 * residual / (n - static_cast<double>(coefficients));
    result[i] = std::max(0.0, (part.dot(y) - chance) / total);
  }
  return result;
}

}  // namespace moma::tune
