#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/batch/batch.h"
#include "eval/stats/comparison.h"
#include "eval/store/tuning.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// The evaluation behind the verdict, on the held-out worlds: the suite's controllers (the tuned one as written is the
/// published one), the search's start if it differs, and the found gains as NAME-tuned.
struct HeldOut {
  Suite suite;  ///< named NAME-held-out
  std::vector<BatchJob> jobs;
  std::vector<std::size_t> part;        ///< part of the mixture of each point
  std::vector<std::string> part_names;  ///< "" if there is one part only
  std::string found;                    ///< name of the found gains' controller
  std::vector<std::string> others;      ///< the other controllers, in order
};

/// Throws config::ConfigError.
HeldOut make_held_out(const Tuning& tuning, const Candidate& found);

struct HeldOutVerdict {
  std::vector<store::TuneComparisonRecord> rows;
  std::string against;                       ///< the other side of `overall`
  Verdict overall = Verdict::kNoDifference;  ///< verdict against the controller as the suite has it
  std::string why;
  std::vector<std::string> constraints;  ///< a line for each constraint
  std::int64_t errors = 0;               ///< worlds against `against` in which a trial ended by an error
  std::optional<stats::PairedRate> success_without_errors;  ///< A: `against`, B: found; set if there are errors
};

/// Compares the found gains with each other controller, for every family and all together, world by world; `rows[j]`
/// belongs to `held_out.jobs[j]`.
/// - success and collision: rates with Wilson's 95 % interval, exact McNemar with Holm's correction over all the
///   p-values of the table; better or worse at p < 0.05;
/// - objective, time to goal (worlds where both succeed), manipulability, command change: means; paired bootstrap
///   interval of the difference, better or worse if it excludes zero.
/// Overall, against the tuned controller as written, on all worlds: worse if success or collision is worse; else better
/// if success or the objective is better; else no difference shown.
HeldOutVerdict judge(const Tuning& tuning, const HeldOut& held_out, const std::vector<TrialRow>& rows);

/// Returns the table as text, with Markdown-like columns.
std::string table(const HeldOutVerdict& verdict);

}  // namespace moma::tune
