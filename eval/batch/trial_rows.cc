#include "eval/batch/trial_rows.h"

#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace moma {

std::vector<TrialRow> trial_rows(std::span<const SuitePoint> points, std::span<const BatchJob> jobs,
                                 BatchOptions options, TrialSource* source, TrialCounts& counts) {
  std::unordered_map<std::string, TrialRow> rows;
  std::unordered_set<std::string> known;
  for (const BatchJob& job : jobs) {
    if (source == nullptr || rows.contains(job.key)) continue;
    if (std::optional<TrialRow> row = source->find(job.key)) {
      ++counts.reused;
      known.insert(job.key);
      rows.emplace(job.key, std::move(*row));
    }
  }
  options.skip = &known;
  std::string late;
  const BatchSummary summary = run_batch(points, jobs, options, [&](const BatchJob& job, BatchResult&& result) {
    TrialRow& row = result.output.row;
    if (is_late(row)) {
      late = row.reason;
      return false;
    }
    ++counts.computed;
    if (row.outcome == Outcome::kError && counts.errors++ == 0) counts.first_error = row.reason;
    if (source != nullptr) source->add(points[job.point], job, result);
    rows.emplace(job.key, std::move(row));
    return true;
  });
  if (!late.empty()) throw Interrupted("real time ran out in a trial, which is not stored: " + late);
  if (summary.stopped) throw Interrupted("");
  std::vector<TrialRow> out;
  out.reserve(jobs.size());
  for (const BatchJob& job : jobs) out.push_back(rows.at(job.key));
  return out;
}

}  // namespace moma
