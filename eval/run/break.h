#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/risk/splitting.h"
#include "eval/run/listener.h"
#include "eval/run/risk.h"
#include "eval/suite/suite.h"
#include "world/world.h"

namespace moma::run {

struct BreakRequest : Request {
  std::uint64_t crude = 1000;  ///< crude trials of each family
  double nearest = 0.01;       ///< share of the nearest trials, which are repeated with other noise
  int noises = 40;             ///< number of other noises
  /// Its first draws are the crude trials, as far as there are so many.
  risk::SplittingOptions splitting{.particles = 50, .draws = 5, .replicates = 4, .levels = 16};
};

/// One kind of failure: a robot shape that touches an object of a world, however often it occurred.
struct Failure {
  std::size_t point = 0;
  std::string family;
  World world;  ///< the failing world as a frozen world
  TrialRow row;
  std::string by;         ///< method that found it first, an indication of its probability: crude, noise, splitting
  std::size_t times = 1;  ///< number of trials with this failure
};

struct Broken : Ended {
  std::vector<Failure> failures;  ///< by point and family; the likeliest first
  std::size_t trials = 0;
};

/// Searches for failures of each point of the suite: in crude trials, with other noise in the nearest worlds, and by
/// splitting (eval/risk/splitting.h), whose last generation samples the worlds given the event. The store gets the
/// trials of all points in the found worlds as suite NAME-found with their motions, if all points have one robot. The
/// same failures come out for any number of threads and stops. Throws RunError if worlds are not drawn by families,
/// store::StoreError.
Broken break_suite(const BreakRequest& request, const Suite& suite, const RareEvent& event,
                   const Listener& listener = {});

}  // namespace moma::run
