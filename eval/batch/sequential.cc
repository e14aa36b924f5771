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

}  // namespace moma
