#include "eval/run/row_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace moma::run {

void RowWarnings::look(const TrialRow& row, bool identifies) {
  if (row.detector_disagreements > 0) {
    ++contradicted_;
    deepest_ = std::max(deepest_, row.detector_deepest_m);
  }
  messages_ += row.lcp_messages > 0;
  // NaN is no difference.
  if (!identifies) {
    latencies_ += std::abs(row.latency_base_off_s) > 0.0 || std::abs(row.latency_joints_off_s) > 0.0;
    for (const double off : {row.latency_base_off_s, row.latency_joints_off_s})
      if (std::abs(off) > std::abs(latency_off_)) latency_off_ = off;
  }
  errors_ += row.outcome == Outcome::kError;
  diverged_ += row.outcome == Outcome::kDiverged;
}

std::vector<std::string> RowWarnings::sentences() const {
  std::vector<std::string> out;
  const auto add = [&out](int trials, const std::string& what, const char* where) {
    if (trials == 0) return;
    out.push_back(fmt::format("{} {} {}: SELECT trial, outcome, reason FROM v_trials WHERE {}", trials,
                              trials == 1 ? "trial" : "trials", what, where));
  };
  add(contradicted_, fmt::format("where the two detectors of contact disagree, by {:.2g} m at most", deepest_),
      "detector_disagreements > 0");
  add(messages_, "with messages of the physics solver", "lcp_messages > 0");
  add(latencies_,
      fmt::format("whose motion contradicts the latencies that the controller was told, by {:+.3g} s at most; "
                  "`prediction.identify` would identify them",
                  latency_off_),
      "latency_base_off_s <> 0 OR latency_joints_off_s <> 0");
  add(diverged_, "that diverged", "outcome = 'diverged'");
  add(errors_, "ended by an error", "outcome = 'error'");
  return out;
}

}  // namespace moma::run
