#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/batch/batch.h"
#include "eval/stats/comparison.h"
#include "eval/store/tuning.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// The evaluation that gives the verdict: the suite's controllers as they stand (the tuned one's preset is the
/// published one), the search's start where it differs, and the found gains as NAME-tuned, all on the held-out worlds.
struct HeldOut {
  Suite suite;  ///< named NAME-held-out
  std::vector<BatchJob> jobs;
  std::vector<std::size_t> part;        ///< of each point
  std::vector<std::string> part_names;  ///< "" where there is one part only
  std::string found;                    ///< name of the found gains' controller
  std::vector<std::string> others;      ///< the other controllers, in order
};

/// Throws config::ConfigError.
HeldOut make_held_out(const Tuning& tuning, const Candidate& found);

struct HeldOutVerdict {
  std::vector<store::TuneComparisonRecord> rows;
  std::string against;                       ///< the controller that `overall` is about
  Verdict overall = Verdict::kNoDifference;  ///< against the controller as the suite has it
  std::string why;
  std::vector<std::string> constraints;  ///< a line for each
  std::int64_t errors = 0;               ///< worlds against `against` where a trial ended by an error: no success
  std::optional<stats::PairedRate> success_without_errors;  ///< A: `against`, B: found; where there are errors
};

/// `rows[j]` belongs to `held_out.jobs[j]`. Compares the found gains with each other controller, for every family and
/// all together, world by world:
/// - success and collision: rates with Wilson's 95 % interval, exact McNemar with Holm's correction over all the
///   p-values of the table; better or worse at p < 0.05;
/// - objective, time to goal (worlds where both succeed), manipulability, command change: means; paired bootstrap
///   interval of the difference, better or worse where it leaves zero out.
/// Overall, against the tuned controller's preset on all worlds: worse where success or collision is; else better where
/// success or the objective is; else no difference shown.
HeldOutVerdict judge(const Tuning& tuning, const HeldOut& held_out, const std::vector<TrialRow>& rows);

/// The table for a person, Markdown-like columns.
std::string table(const HeldOutVerdict& verdict);

}  // namespace moma::tune
