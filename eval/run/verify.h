#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>

#include "eval/run/listener.h"

namespace moma::run {

struct VerifyRequest {
  std::filesystem::path file;
  double fraction = 0.1;  ///< of the trials; at least one
  std::int64_t seed = 1;  ///< chooses other trials
  int threads = 0;        ///< 0: one per core
  const std::atomic<bool>* stop = nullptr;
};

struct Verification {
  std::size_t trials = 0;  ///< in the store
  std::size_t replayed = 0;
  std::size_t skipped = 0;   ///< cannot be: another version of the simulation, or no world
  std::size_t findings = 0;  ///< told to Listener::warning as they are found
  std::string hash;          ///< over every result: equal hashes mean equal rows
  End end = End::kFinished;
};

/// Replays a fraction of a store's trials, compares bit for bit, and looks for damage. Throws store::StoreError.
Verification verify(const VerifyRequest& request, const Listener& listener = {});

}  // namespace moma::run
