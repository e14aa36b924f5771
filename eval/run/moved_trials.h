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

/// A world of a suite's families whose random numbers were moved (world/moves.h).
struct MovedWorld {
  std::uint64_t index = 0;
  std::shared_ptr<const Moves> moves;  ///< null: none, so that it is the suite's own world
};

/// The move by which all disturbances are drawn anew, by number `number`.
std::shared_ptr<const Moves> noise_drawn_again(int number);

/// Throws RunError where a point's worlds are not drawn by families, so that there are no others.
void check_drawn(const Suite& suite, std::string_view command);

/// The stop flag was set, or, with a text, real time ran out in a trial. What was computed is in the store.
class Stopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Trials of a suite's points in moved worlds, on all cores. Those that the store has under their keys are not
/// computed; new ones go there, but for errors, without samples.
class MovedTrials {
 public:
  /// `writer`, whose begin() was called, may be null; all arguments have to outlive this.
  MovedTrials(const Suite& suite, store::Writer* writer, int threads, const std::atomic<bool>* stop,
              const Listener& listener)
      : suite_(suite), writer_(writer), threads_(threads), stop_(stop), listener_(listener) {}

  /// In the order of `worlds`; the same for any number of threads. Throws Stopped, store::StoreError.
  /// `progress`: tells the listener after each trial.
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

/// Who asks for moved trials, and where they are kept.
struct MovedTrialsRequest {
  std::filesystem::path file;          ///< store, made where it is missing; empty: no trial is kept
  std::vector<std::string> arguments;  ///< the command line, for provenance and "to go on"
  int threads = 0;                     ///< 0: usual_threads()
  const std::atomic<bool>* stop = nullptr;
};

/// Does `work` with trials of a suite under the store's lock. `stopped`: where it did not finish, what is saved and how
/// to go on. Throws store::StoreError and what `work` throws.
End with_moved_trials(const MovedTrialsRequest& request, const Suite& suite, const Listener& listener,
                      const std::function<void(MovedTrials&)>& work, std::string& stopped);

}  // namespace moma::run
