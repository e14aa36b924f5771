#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "eval/batch/batch.h"

namespace moma::run {

/// What is asked for does not go together, or a file cannot be written; what() is complete, for a person.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a run tells while it goes on; members may be empty. Called by one thread at a time. Texts are sentences for a
/// person without a line end, and may hold anything that files and stores hold.
struct Listener {
  std::function<void(const std::string&)> note;        ///< what is being done
  std::function<void(const std::string&)> notice;      ///< what a person has to know to understand a wait or a loss
  std::function<void(const std::string&)> warning;     ///< what makes results doubtful
  std::function<void(const BatchProgress&)> progress;  ///< after each trial
  std::function<void()> progress_end;                  ///< no progress for a while; other texts may follow

  void tell(const std::function<void(const std::string&)>& to, const std::string& text) const {
    if (to) to(text);
  }
};

/// How a run ended. A store always holds what was done.
enum class End {
  kFinished,
  kStopped,     ///< by the stop flag, or incomplete: real time ran out in some trials
  kNeverBegan,  ///< stopped while it waited for another run on the same store
  kSameError,   ///< a point's first trials, or all of them, ended by one error: what is asked for cannot work
};

}  // namespace moma::run
