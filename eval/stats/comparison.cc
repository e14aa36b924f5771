#include "eval/stats/comparison.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace moma::stats {
namespace {

constexpr double kSignificance = 0.05;

Share share(std::int64_t count, std::int64_t n) {
  if (n == 0) return {};
  return {count, static_cast<double>(count) / static_cast<double>(n), wilson(count, n)};
}

PairedRate rate_of(const char* name, std::span<const std::pair<Ending, Ending>> endings, bool Ending::*hit) {
  std::vector<std::pair<bool, bool>> hits;
  for (const auto& [a, b] : endings) hits.emplace_back(a.*hit, b.*hit);
  return paired_rate(name, hits);
}

template <class Row>
const Row& named(const std::vector<Row>& rows, const std::string& name) {
  const auto found = std::ranges::find_if(rows, [&](const Row& row) { return row.name == name; });
  if (found == rows.end()) throw std::out_of_range("the comparison has no " + name);
  return *found;
}

}  // namespace

int PairedRate::shown() const {
  if (!(p_holm < kSignificance) || difference == 0.0) return 0;
  return difference > 0.0 ? 1 : -1;
}

int PairedMean::shown() const { return interval.low > 0.0 ? 1 : interval.high < 0.0 ? -1 : 0; }

const PairedRate& Comparison::rate(const std::string& name) const { return named(rates, name); }
const PairedMean& Comparison::mean(const std::string& name) const { return named(means, name); }

PairedRate paired_rate(std::string name, std::span<const std::pair<bool, bool>> hits) {
  PairedRate rate;
  rate.name = std::move(name);
  rate.n = static_cast<std::int64_t>(hits.size());
  std::int64_t in_a = 0, in_b = 0;
  for (const auto& [a, b] : hits) {
    in_a += a ? 1 : 0;
    in_b += b ? 1 : 0;
    rate.only_a += a && !b ? 1 : 0;
    rate.only_b += b && !a ? 1 : 0;
  }
  rate.a = share(in_a, rate.n);
  rate.b = share(in_b, rate.n);
  rate.p = mcnemar_exact(rate.only_a, rate.only_b);
  if (rate.n == 0) return rate;
  rate.difference = static_cast<double>(rate.only_b - rate.only_a) / static_cast<double>(rate.n);
  rate.interval = difference_of_paired_rates(rate.only_b, rate.only_a, rate.n);
  return rate;
}

PairedMean paired_mean(const PairedValues& values) {
  if (values.a.size() != values.b.size()) throw std::invalid_argument("paired_mean: sizes differ");
  std::vector<double> a, b;
  for (std::size_t i = 0; i < values.a.size(); ++i) {
    if (std::isnan(values.a[i]) || std::isnan(values.b[i])) continue;
    a.push_back(values.a[i]);
    b.push_back(values.b[i]);
  }
  PairedMean mean;
  mean.name = values.name;
  mean.n = static_cast<std::int64_t>(a.size());
  if (a.empty()) return mean;
  const std::vector<double> zero(a.size(), 0.0);
  const MeanDifference of_a = paired_bootstrap(a, zero), of_b = paired_bootstrap(b, zero), d = paired_bootstrap(b, a);
  mean.a = of_a.mean;
  mean.b = of_b.mean;
  mean.of_a = {of_a.low, of_a.high};
  mean.of_b = {of_b.low, of_b.high};
  mean.difference = d.mean;
  mean.interval = {d.low, d.high};
  return mean;
}

void correct_by_holm(std::span<PairedRate* const> rates) {
  std::vector<double> p;
  for (const PairedRate* rate : rates) p.push_back(rate->p);
  const std::vector<double> adjusted = holm(p);
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i]->p_holm = adjusted[i];
}

Comparison compare(std::span<const std::pair<Ending, Ending>> endings, std::span<const PairedValues> metrics) {
  Comparison comparison;
  comparison.n = static_cast<std::int64_t>(endings.size());
  std::vector<std::pair<Ending, Ending>> sound;
  for (const auto& pair : endings) {
    comparison.errors_a += pair.first.error ? 1 : 0;
    comparison.errors_b += pair.second.error ? 1 : 0;
    if (!pair.first.error && !pair.second.error) sound.push_back(pair);
  }
  comparison.worlds_with_errors = comparison.n - static_cast<std::int64_t>(sound.size());
  comparison.rates = {rate_of("success", endings, &Ending::success), rate_of("collision", endings, &Ending::collision)};
  PairedRate* const corrected[] = {comparison.rates.data(), comparison.rates.data() + 1};
  correct_by_holm(corrected);
  if (comparison.worlds_with_errors > 0)
    comparison.sans_errors = rate_of("success without errors", sound, &Ending::success);
  for (const PairedValues& values : metrics) comparison.means.push_back(paired_mean(values));
  return comparison;
}

}  // namespace moma::stats
