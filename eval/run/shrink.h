#pragma once

#include <string>
#include <vector>

#include "controller/config/json.h"
#include "eval/run/listener.h"
#include "eval/run/replay.h"
#include "eval/trial/row.h"
#include "world/world.h"

namespace moma::run {

struct ShrinkRequest : Request {
  std::string trial;  ///< the trial's name or any unique prefix of it
  int noises = 8;     ///< number of draws of the disturbances for each candidate
  Plugins plugins = Plugins::kRefused;
};

/// The smallest world with the trial's failure.
struct Shrunk {
  End end = End::kFinished;
  World world;        ///< fails with its own noise; objects keep the numbers of their noise
  Json disturbances;  ///< remaining disturbances, as in a suite; {}: none
  TrialRow row;       ///< row of the trial in the smallest world
  std::size_t objects_before = 0;
  int failing = 0, noises = 0;       ///< number of noises with a failure, and of all noises, including the world's own
  std::vector<std::string> on;       ///< remaining disturbances, "base.delay"
  std::vector<std::string> changed;  ///< other simplifications, in words
  std::size_t trials = 0;            ///< number of simulated trials
  std::string sentence;
};

/// Finds the smallest world in which a stored trial's point still fails by the same outcome, a collision with the same
/// object, before twice its time and a second. A candidate is accepted if it fails in as many noises as the trial's
/// world, or in half of them; the first failing noise becomes its own. Other noises than the world's own are simulated
/// only while candidates that pass in their own noise still fail in others. The search tries in turn: fewer goals;
/// fewer objects (eval/risk/shrink_set.h), each of which keeps its own noise; disturbances off; objects at rest; a
/// later start; a nearer goal; rounded numbers. Last, with all noises simulated, no single object can be taken away.
/// The same world and number of trials result for any number of threads. Throws store::StoreError; RunError if the
/// trial did not fail, or does not fail again.
Shrunk shrink(const ShrinkRequest& request, const Listener& listener = {});

}  // namespace moma::run
