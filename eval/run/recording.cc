#include "eval/run/recording.h"

#include <map>
#include <memory>

#include "controller/config/node.h"
#include "eval/store/user_metrics.h"

namespace moma::run {

void drop_samples(SamplesKept kept, TrialOutput& output) {
  const bool keep =
      kept == SamplesKept::kAll || (kept == SamplesKept::kFailures && output.row.outcome != Outcome::kSuccess);
  if (!keep) Trace().swap(output.trace);
}

std::function<void(const SuitePoint&, BatchResult&)> finishing(const Suite& suite) {
  std::map<const void*, std::shared_ptr<const store::UserMetrics>> metrics;  // by robot, because columns differ
  if (!suite.metrics.empty()) {
    for (const SuitePoint& point : suite.points) {
      auto& one = metrics[point.robot.get()];
      const RobotModel& robot = *point.robot->model;
      try {
        if (one == nullptr)
          one = std::make_shared<store::UserMetrics>(suite.metrics, robot.num_joints(), robot.num_velocities());
      } catch (const store::MetricError& error) {
        config::fail(suite.metric_marks.at(error.metric), "metrics." + suite.metrics[error.metric].first, error.what());
      }
    }
  }
  return [kept = suite.samples, metrics](const SuitePoint& point, BatchResult& result) {
    if (const auto found = metrics.find(point.robot.get()); found != metrics.end())
      result.metrics = found->second->evaluate(result.output.trace);
    drop_samples(kept, result.output);
  };
}

store::WorldRecord world_record(const SuitePoint& point, const BatchJob& job, const BatchResult& result) {
  return result.world != nullptr ? store::describe(*result.world) : store::describe_missing(point.worlds, job.world);
}

}  // namespace moma::run
