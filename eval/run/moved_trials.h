#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/batch/trial_rows.h"
#include "eval/run/listener.h"
#include "eval/store/writer.h"
#include "eval/suite/suite.h"
#include "eval/trial/row.h"

namespace moma::run {

/// A world of a suite's families with moved random numbers (world/draws.h).
struct MovedWorld {
  std::uint64_t index = 0;
  std::shared_ptr<const Moves> moves;  ///< null: no moves, the suite's own world
};

/// Returns the move that draws all disturbances anew, by number `number`.
std::shared_ptr<const Moves> noise_drawn_again(int number);

/// Throws RunError if a point's worlds are not drawn by families: such worlds cannot be moved.
void check_drawn(const Suite& suite, std::string_view command);

/// Trials of a suite's points in moved worlds, on all cores and ranks. Trials that the store has under their keys are
/// not computed. New ones are stored without samples, except errors.
class MovedTrials {
 public:
  /// `writer`, after its begin(), may be null; without it rows may lack time bounds unless `level`, the metric that is
  /// looked at, is one of them: they take half of a short trial. The other arguments must outlive this object.
  MovedTrials(const Suite& suite, store::Writer* writer, std::string_view level, const Request& request,
              const Listener& listener)
      : suite_(suite),
        writer_(writer),
        time_bound_(writer != nullptr || level.find("bound") != std::string_view::npos),
        request_(request),
        listener_(listener) {}

  /// Returns rows in the order of `worlds`, the same for any number of threads. `progress`: notifies the listener after
  /// each trial. Throws Interrupted, store::StoreError.
  std::vector<TrialRow> rows(std::size_t point, std::span<const MovedWorld> worlds, bool progress = false);

  /// Stores the estimates of a risk command with its invocation, for the page; does nothing without a store.
  void keep(const Json& estimates);

  const TrialCounts& counts() const { return counts_; }

 private:
  const Suite& suite_;
  store::Writer* writer_;
  bool time_bound_;
  const Request& request_;
  const Listener& listener_;
  TrialCounts counts_;
};

/// Calls `work` with the trials of a suite under the store's lock; without a file no trial is stored. `level`: the
/// metric that `work` looks at. Throws store::StoreError and the exceptions of `work`.
Ended with_moved_trials(const Request& request, const Suite& suite, std::string_view level, const Listener& listener,
                        const std::function<void(MovedTrials&)>& work);

}  // namespace moma::run
