#include "eval/run/store_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <string_view>
#include <thread>

#include "controller/config/node.h"
#include "controller/describe/enumeration.h"
#include "eval/store/database.h"
#include "eval/store/user_metrics.h"
#include "world/world_json.h"

namespace moma::run {
namespace {

/// Quotes one shell word.
std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-./=,:@%+").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

fs::path usual_store(const std::string& suite, const std::string& part) {
  std::string name = suite;
  std::replace(name.begin(), name.end(), '/', '_');
  std::error_code error;
  fs::create_directory("results", error);  // if that fails, opening the store reports the reason
  return fs::path("results") / (name + part + ".db");
}

std::string command_line(const std::vector<std::string>& arguments) { return joined(arguments, &shell_word, " "); }

std::string stopped_text(const std::string& what, const std::string& saved, const fs::path& file,
                         const std::vector<std::string>& arguments) {
  return fmt::format("stopped{}{}: {} saved in {}; to go on: {}", what.empty() ? "" : " ", what, saved, file.string(),
                     command_line(arguments));
}

std::string no_end_text(const std::string& started, bool lock_left) {
  return lock_left ? fmt::format("the run of {} was killed; its saved trials are there", started)
                   : fmt::format(
                         "the run of {} has no end, and no lock of it is beside this store: a copy that was "
                         "taken meanwhile lacks the trials of its -wal file; moma merge makes whole copies",
                         started);
}

void tell_opened(store::Writer& writer, const store::RunLock& lock, const fs::path& file, const Listener& listener) {
  if (lock.exclusive())
    for (const std::string& when : writer.close_killed()) listener.note(no_end_text(when, lock.was_there()));
  if (const std::size_t late = writer.forgotten(); late > 0)
    listener.note(fmt::format("{} stored errors came from a busy machine: they are tried again", late));
  if (const std::string warning = store::file_system_warning(file); !warning.empty()) listener.warning(warning);
}

int usual_threads(bool cluster) {
  return cluster ? 1 : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int threads_of(const Request& request) {
  return request.threads > 0 ? request.threads : usual_threads(request.cluster != nullptr);
}

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
  if (result.world != nullptr && job.moves == nullptr) return store::describe(*result.world);
  store::WorldRecord record = store::describe_missing(point.worlds, job.world);
  if (job.moves == nullptr) return record;
  auto json = Json::parse(record.json);
  json["moves"] = to_json(*job.moves);
  record.json = json.dump();
  return record;
}

void StoredTrials::add(const SuitePoint& point, const BatchJob& job, const BatchResult& result) {
  const bool lone = of_ == Of::kSearch;
  const Trace& trace = result.output.trace;
  writer_.add({lone ? store::kNoPoint : job.point, job.world, job.key}, world_record(point, job, result),
              result.output.row, lone || trace.empty() ? nullptr : &trace);
}

}  // namespace moma::run
