#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "eval/run/listener.h"
#include "eval/store/writer.h"
#include "eval/suite/suite.h"
#include "eval/trial/row.h"

namespace moma::run {

/// A world of a suite's families with moved random numbers (world/moves.h).
struct MovedWorld {
  std::uint64_t index = 0;
  std::shared_ptr<const Moves> moves;  ///< null: no moves, the suite's own world
};

/// Returns the move that draws all disturbances anew, by number `number`.
std::shared_ptr<const Moves> noise_drawn_again(int number);

/// Throws RunError if a point's worlds are not drawn by families: such worlds cannot be moved.
void check_drawn(const Suite& suite, std::string_view command);

/// The stop flag was set or, with a text, real time ran out in a trial. The store holds the computed trials.
class Stopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Trials of a suite's points in moved worlds, on all cores. Trials that the store has under their keys are not
/// computed. New ones are stored without samples, except errors.
class MovedTrials {
 public:
  /// `writer`, after its begin(), may be null. All arguments must outlive this object.
  MovedTrials(const Suite& suite, store::Writer* writer, int threads, const std::atomic<bool>* stop,
              const Listener& listener)
      : suite_(suite), writer_(writer), threads_(threads), stop_(stop), listener_(listener) {}

  /// Returns rows in the order of `worlds`, the same for any number of threads. `progress`: notifies the listener after
  /// each trial. Throws Stopped, store::StoreError.
  std::vector<TrialRow> rows(std::size_t point, std::span<const MovedWorld> worlds, bool progress = false);

  std::size_t computed() const { return computed_; }
  std::size_t reused() const { return reused_; }
  std::size_t errors() const { return errors_; }
  const std::string& first_error() const { return first_error_; }

 private:
  const Suite& suite_;
  store::Writer* writer_;
  int threads_;
  const std::atomic<bool>* stop_;
  const Listener& listener_;
  std::size_t computed_ = 0, reused_ = 0, errors_ = 0;
  std::string first_error_;
};

struct MovedTrialsRequest {
  std::filesystem::path file;          ///< store, created if missing; empty: no trial is stored
  std::vector<std::string> arguments;  ///< the command line, for provenance and "to go on"
  int threads = 0;                     ///< 0: usual_threads()
  const std::atomic<bool>* stop = nullptr;
};

/// Calls `work` with the trials of a suite under the store's lock. `stopped`: if not finished, the saved work and the
/// command to go on. Throws store::StoreError and the exceptions of `work`.
End with_moved_trials(const MovedTrialsRequest& request, const Suite& suite, const Listener& listener,
                      const std::function<void(MovedTrials&)>& work, std::string& stopped);

}  // namespace moma::run
