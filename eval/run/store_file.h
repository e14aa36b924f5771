#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "eval/batch/trial_rows.h"
#include "eval/run/listener.h"
#include "eval/store/run_lock.h"
#include "eval/store/writer.h"

namespace moma::run {

/// Returns the default store, results/NAME.db in the working directory, and creates the folder. `part` follows the
/// name, e.g. ".shard-1-of-8".
fs::path usual_store(const std::string& suite, const std::string& part = "");

/// Returns arguments quoted for a shell.
std::string command_line(const std::vector<std::string>& arguments);

/// Returns "stopped WHAT: SAVED saved in FILE; to go on: COMMAND".
std::string stopped_text(const std::string& what, const std::string& saved, const fs::path& file,
                         const std::vector<std::string>& arguments);

/// Describes a run without an end that no process works on: it was killed or, if no lock is beside the store, the file
/// is a copy that was taken during the run.
std::string no_end_text(const std::string& started, bool lock_left);

/// Tells what a writer, before its begin(), found in the store: runs that were killed, unless another process may be
/// writing; errors that are tried again; a file system whose locks cannot be trusted.
void tell_opened(store::Writer& writer, const store::RunLock& lock, const fs::path& file, const Listener& listener);

/// Returns the number of cores, or one thread per rank of an mpirun: ranks are usually as many as cores.
int usual_threads(bool cluster = false);
/// Returns the number of threads that a request asks for.
int threads_of(const Request& request);

/// Drops the samples that a suite does not keep: all, none, or those of successes.
void drop_samples(SamplesKept kept, TrialOutput& output);

/// Returns the BatchOptions::finish of every process: it evaluates the suite's own metrics and drops the samples that
/// the suite does not keep. Throws config::ConfigError if a metric's SQL is invalid.
std::function<void(const SuitePoint&, BatchResult&)> finishing(const Suite& suite);

/// Returns the record of a result's world, even if the world could not be made. That of a moved world has no content:
/// they are too many to store, and can be drawn again.
store::WorldRecord world_record(const SuitePoint& point, const BatchJob& job, const BatchResult& result);

/// Trials in a store, after the writer's begin(): those of its suite's points with their samples, or lone ones, of a
/// search, without.
class StoredTrials : public TrialSource {
 public:
  enum class Of { kPoints, kSearch };
  StoredTrials(store::Writer& writer, Of of) : writer_(writer), of_(of) {}
  std::optional<TrialRow> find(const std::string& key) override { return writer_.find(key); }
  void add(const SuitePoint& point, const BatchJob& job, const BatchResult& result) override;

 private:
  store::Writer& writer_;
  Of of_;
};

}  // namespace moma::run
