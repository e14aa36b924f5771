#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "eval/batch/cluster.h"
#include "eval/run/listener.h"
#include "eval/suite/suite.h"

namespace moma::run {

/// Part `index` of `count`, from 1: the worlds whose index leaves `index` - 1 when divided by `count`, for all points.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
  bool has(std::uint64_t world) const { return world % count == index - 1; }
};

struct EvaluateRequest {
  std::filesystem::path file;          ///< store, made where it is missing; usual_store() where empty
  std::vector<std::string> arguments;  ///< the command line, for provenance and "to go on"
  int threads = 0;                     ///< 0: usual_threads()
  Shard shard;
  bool profile = false;                     ///< tells where the time of trials went
  bool keep_going = false;                  ///< goes on where a point's first trials all end by the same error
  Cluster* cluster = nullptr;               ///< rank 0 of an mpirun
  const std::atomic<bool>* stop = nullptr;  ///< set: trials in flight finish and are saved
};

struct Evaluation {
  End end = End::kFinished;
  std::filesystem::path file;
  std::string suite;                  ///< its name in the store's views
  std::string stopped;                ///< where it did not finish: what is saved and how to go on, or the error
  std::vector<std::string> warnings;  ///< what the rows say against the physics
  Profile profile;                    ///< of the trials that were computed, the store's work included; where asked for
};

/// Evaluates a suite into a store, going on from what is there: alone, as a shard, or with the ranks of a cluster. The
/// same store comes out whatever the number of computers and stops. Throws store::StoreError (whose text says how to go
/// on), RunError.
Evaluation evaluate(const EvaluateRequest& request, const Suite& suite, const Listener& listener = {});

/// A rank other than 0: computes what rank 0 hands out, until it says that it is over. It gets the suite from rank 0
/// and reads no file. `profile`: as of the request, which every rank was started with.
void follow(Cluster& cluster, int threads, bool profile = false);

}  // namespace moma::run
