#pragma once

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/run/listener.h"
#include "eval/run/replay.h"
#include "eval/trial/row.h"
#include "world/world.h"

namespace moma::run {

struct ShrinkRequest {
  std::filesystem::path file;  ///< store
  std::string trial;           ///< its name, or any unique beginning of it
  int noises = 8;              ///< draws of the disturbances under which a world is asked whether it fails
  int threads = 0;             ///< 0: usual_threads()
  Plugins plugins = Plugins::kRefused;
  const std::atomic<bool>* stop = nullptr;
};

/// A world that fails as the trial did.
struct Shrunk {
  End end = End::kFinished;
  World world;                          ///< fails by its own noise; objects keep the numbers of theirs
  nlohmann::ordered_json disturbances;  ///< those that were left, as in a suite; {}: none
  TrialRow row;                         ///< of its trial
  std::size_t objects_before = 0;
  int failing = 0, noises = 0;       ///< fails in so many of so many noises, its own among them
  std::vector<std::string> on;       ///< disturbances that were left, "base.delay"
  std::vector<std::string> changed;  ///< what else could be made simpler, in words
  std::size_t trials = 0;            ///< simulated
  std::string sentence;
};

/// Finds the smallest world in which a stored trial's point still fails as it did there: by the same outcome, a
/// collision with the same object. A candidate counts where it fails in as many noises as the trial's world, or in half
/// of them; the first of these becomes its own.
/// In turn: fewer objects (eval/risk/shrink_set.h), each of which keeps its own noise; disturbances off; objects at
/// rest; a later start; a nearer goal; rounded numbers. The same world comes out for any number of threads. Throws
/// store::StoreError; RunError where the trial did not fail, or does not fail again.
Shrunk shrink(const ShrinkRequest& request, const Listener& listener = {});

}  // namespace moma::run
