#pragma once

#include <optional>
#include <string>

#include "eval/run/listener.h"
#include "eval/search/search.h"
#include "eval/tune/held_out.h"
#include "eval/tune/trial_objective.h"
#include "eval/tune/tuning.h"
#include "files/output_file.h"

namespace moma::run {

/// `file`: usual_store() if empty.
struct TuneRequest : Request {
  fs::path gains;                                 ///< file for the gains found; if empty, the suite's
                                                  ///< `output`, else configs/controllers/NAME-tuned.yaml
  bool verdict = true;                            ///< judge the gains found on the held-out worlds
  files::Replace replace = files::Replace::kOwn;  ///< files that the gains may replace
};

struct TuneListener : Listener {
  std::function<void()> trial = {};                            ///< the search computed a trial; may be empty
  std::function<void(const tune::Progress&)> evaluation = {};  ///< an evaluation ended; may be empty
  /// The search ended; the verdict comes next.
  std::function<void(const tune::SearchResult&)> searched = [](const tune::SearchResult&) {};
  /// The verdict is there; the gains are written next.
  std::function<void(const tune::HeldOutVerdict&)> judged = [](const tune::HeldOutVerdict&) {};
};

struct Tuned : Ended {
  std::optional<tune::SearchResult> search;     ///< empty if stopped before its end
  std::optional<tune::HeldOutVerdict> verdict;  ///< empty if not requested, or stopped before its end
  fs::path gains;  ///< file written; empty if stopped, or without improvement over the start
};

/// Searches the gains of a suite's controller into a store, continues from its contents, judges the gains on worlds
/// that took no part in the search, and writes them as a controller file. The same gains result for any number of
/// threads and stops. Throws store::StoreError, RunError, config::ConfigError, tune::ReplayError, and
/// files::OutputError if the gains file is not writable, before any computation.
Tuned tune(const TuneRequest& request, const tune::Tuning& tuning, const TuneListener& listener = {});

}  // namespace moma::run
