#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/run/listener.h"
#include "eval/search/search.h"
#include "eval/tune/held_out.h"
#include "eval/tune/trial_objective.h"
#include "eval/tune/tuning.h"
#include "files/output_file.h"

namespace moma::run {

struct TuneRequest {
  std::filesystem::path file;                     ///< store, made where it is missing; usual_store() where empty
  std::filesystem::path gains;                    ///< for the found gains; usual_gains() where empty
  std::vector<std::string> arguments;             ///< the command line, for provenance and "to go on"
  int threads = 0;                                ///< 0: usual_threads()
  bool verdict = true;                            ///< judge what was found on the held-out worlds
  files::Replace replace = files::Replace::kOwn;  ///< what may stand where the gains go
  const std::atomic<bool>* stop = nullptr;
};

/// What a search tells besides what every run does.
struct TuneListener : Listener {
  std::function<void()> trial;                              ///< the search computed a trial
  std::function<void(const tune::Progress&)> evaluation;    ///< an evaluation ended
  std::function<void(const tune::SearchResult&)> searched;  ///< the search ended; the verdict comes next
  std::function<void(const tune::HeldOutVerdict&)> judged;  ///< the verdict is there; the gains are written next
};

struct Tuned {
  End end = End::kFinished;
  std::string stopped;                          ///< where it did not finish: what is saved and how to go on
  std::optional<tune::SearchResult> search;     ///< none where it was stopped before its end
  std::optional<tune::HeldOutVerdict> verdict;  ///< none where it was not asked for, or stopped before its end
  std::filesystem::path gains;                  ///< written; empty where stopped, or no better than the start was found
};

/// The file that the suite names, else configs/controllers/CONTROLLER-tuned.yaml, or without that folder in the working
/// directory.
std::filesystem::path usual_gains(const tune::Tuning& tuning);

/// Searches the gains of a suite's controller into a store, going on from what is there, judges them on worlds that
/// took no part in the search, and writes them as a controller file. The same gains come out whatever the number of
/// threads and stops. Throws store::StoreError, RunError, config::ConfigError, tune::ReplayError,
/// files::OutputError where the gains cannot be written, before anything is computed.
Tuned tune(const TuneRequest& request, const tune::Tuning& tuning, const TuneListener& listener = {});

}  // namespace moma::run
