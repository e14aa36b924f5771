#pragma once

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "eval/batch/cluster.h"

namespace moma::run {

/// A request with contradictory parts, or a file that cannot be written; what() is complete, for a person.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Members of every request.
struct Request {
  fs::path file;                            ///< store; where one is written, it is created if missing
  std::vector<std::string> arguments;       ///< the command line, for provenance and "to go on"
  int threads = 0;                          ///< 0: usual_threads()
  const std::atomic<bool>* stop = nullptr;  ///< if set, trials in flight finish and are saved
  Cluster* cluster = nullptr;               ///< set on rank 0 of an mpirun
};

/// Callbacks during a run, called from one thread at a time. Texts are sentences for a person without a line end, and
/// may contain anything that files and stores contain.
struct Listener {
  using Text = std::function<void(const std::string&)>;
  Text note = [](const std::string&) {};               ///< present activity
  Text notice = [](const std::string&) {};             ///< reason of a wait or a loss
  Text warning = [](const std::string&) {};            ///< reason for doubt about results
  std::function<void(const BatchProgress&)> progress;  ///< after each trial; may be empty
  std::function<void()> progress_end = [] {};          ///< progress pauses; other texts may follow
};

/// The end of a run. The store always holds the finished trials.
enum class End {
  kFinished,
  kStopped,     ///< by the stop flag, or incomplete because real time ran out in some trials
  kNeverBegan,  ///< stopped while waiting for another run on the same store
  kSameError,   ///< a point's first trials, or all of them, ended by one error: the request cannot work
};

/// How a run ended.
struct Ended {
  End end = End::kFinished;
  std::string stopped = {};  ///< if not finished: the saved work and the command to go on, or the error
};

}  // namespace moma::run
