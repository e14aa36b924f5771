#include "eval/batch/sequential.h"

#include <algorithm>

#include "eval/stats/intervals.h"

namespace moma {
namespace {

double half_width_of(std::int64_t hits, std::uint64_t worlds) {
  const stats::Interval interval = stats::wilson(hits, static_cast<std::int64_t>(worlds));
  return (interval.high - interval.low) / 2;
}

}  // namespace

SequentialRule::SequentialRule(const UntilRule& rule, std::size_t points) : rule_(rule), hits_(points, 0) {}

std::uint64_t SequentialRule::next_block() const { return reached() ? 0 : std::min(rule_.block, rule_.max - worlds_); }

void SequentialRule::add(std::size_t point, Outcome outcome) {
  if (to_string(outcome) == rule_.metric) ++hits_.at(point);
}

void SequentialRule::end_block(std::uint64_t worlds) {
  worlds_ += worlds;
  half_width_ = 0.0;
  for (const std::int64_t hits : hits_) half_width_ = std::max(half_width_, half_width_of(hits, worlds_));
}

StoppedCoverage stopped_coverage(const UntilRule& rule, double p) {
  StoppedCoverage result;
  std::vector<double> open{1.0};  // probability of each count among the samples that continue
  for (std::uint64_t n = 0; n < rule.max;) {
    const std::uint64_t block = std::min(rule.block, rule.max - n);
    for (std::uint64_t i = 0; i < block; ++i) {  // one more world
      open.push_back(0.0);
      for (std::size_t k = open.size() - 1; k > 0; --k) open[k] = open[k] * (1.0 - p) + open[k - 1] * p;
      open[0] *= 1.0 - p;
    }
    n += block;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const stats::Interval interval = stats::wilson(static_cast<std::int64_t>(k), static_cast<std::int64_t>(n));
      if (n < rule.max && (interval.high - interval.low) / 2 > rule.half_width) continue;
      if (interval.low <= p && p <= interval.high) result.coverage += open[k];
      result.mean_worlds += static_cast<double>(n) * open[k];
      open[k] = 0.0;
    }
  }
  return result;
}

}  // namespace moma
