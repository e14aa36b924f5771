#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "eval/risk/splitting.h"
#include "eval/run/listener.h"
#include "eval/run/moved_trials.h"
#include "eval/run/rare_event.h"
#include "eval/suite/suite.h"
#include "world/world.h"

namespace moma::run {

struct BreakRequest {
  MovedTrialsRequest trials;
  std::uint64_t crude = 1000;  ///< trials of each family that are looked at first
  double nearest = 0.01;       ///< part of them, those that came nearest, whose noise is drawn again
  int noises = 40;             ///< times
  risk::SplittingOptions splitting{.particles = 50, .replicates = 4, .levels = 16};
};

/// One way to fail: the same robot shape against the same object in the same world, however often it was found.
struct Failure {
  std::size_t point = 0;
  std::string family;
  World world;  ///< fails again as a frozen world
  TrialRow row;
  std::string by;         ///< crude, noise, splitting: the first that found it, and so how likely it is
  std::size_t times = 1;  ///< trials in which it was found
};

struct Broken {
  End end = End::kFinished;
  std::string stopped;
  std::vector<Failure> failures;  ///< by point and family; the likeliest first
  std::size_t trials = 0;
};

/// Looks for failures of each point of the suite: among crude trials, by other noise where those came nearest, and by
/// splitting (eval/risk/splitting.h), whose last generation are draws of what is left when the event happens. The same
/// failures come out for any number of threads and stops. Throws RunError where worlds are not drawn by families,
/// store::StoreError.
Broken break_suite(const BreakRequest& request, const Suite& suite, const RareEvent& event,
                   const Listener& listener = {});

}  // namespace moma::run
