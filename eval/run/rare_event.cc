#include "eval/run/rare_event.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "eval/risk/splitting.h"

namespace moma::run {
namespace {

/// The score of an outcome: how near a trial came to it.
struct Nearness {
  Outcome outcome;
  const char* metric;
  double sign;
};
constexpr Nearness kNearness[] = {{Outcome::kCollision, "clearance_min_m", -1.0},
                                  {Outcome::kTimeout, "time_end_s", 1.0},
                                  {Outcome::kStuck, "position_error_m", 1.0},
                                  {Outcome::kJointLimit, "limit_margin_min", -1.0},
                                  {Outcome::kInfeasible, "fallback_brake", 1.0}};

}  // namespace

RareEvent RareEvent::read(std::string_view text) {
  const std::size_t sign = text.find_first_of("<>");
  if (sign != std::string_view::npos) {
    RareEvent event(text, tune::Metric::find(text.substr(0, sign)), text[sign] == '<' ? -1.0 : 1.0);
    const std::string_view number = text.substr(sign + 1);
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), event.value_);
    if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(event.value_))
      throw std::invalid_argument(fmt::format("'{}' in {} is not a number", number, text));
    return event;
  }
  for (const Nearness& known : kNearness) {
    if (text != to_string(known.outcome)) continue;
    RareEvent event(text, tune::Metric::find(known.metric), known.sign);
    event.outcome_ = known.outcome;
    return event;
  }
  std::string list;
  for (const Nearness& known : kNearness) list += fmt::format("{}, ", to_string(known.outcome));
  throw std::invalid_argument(fmt::format("unknown event '{}'; expected {}METRIC<VALUE or METRIC>VALUE", text, list));
}

bool RareEvent::happened(const TrialRow& row) const {
  if (outcome_) return row.outcome == *outcome_;
  return row.outcome != Outcome::kError && sign_ * (level_.value(row) - value_) > 0.0;
}

double RareEvent::score(const TrialRow& row) const {
  if (happened(row)) return risk::kEvent;
  const double value = row.outcome == Outcome::kError ? kAbsent : sign_ * level_.value(row);
  return std::isnan(value) ? -std::numeric_limits<double>::infinity() : value;
}

}  // namespace moma::run
