#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/run/listener.h"
#include "eval/suite/suite.h"

namespace moma::run {

/// Part `index` of `count`, from 1: the worlds whose index is `index` - 1 modulo `count`, for all points.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
  bool has(std::uint64_t world) const { return world % count == index - 1; }
};

/// `file`: usual_store() if empty.
struct EvaluateRequest : Request {
  Shard shard;
  bool profile = false;     ///< measure the parts of the trials' time
  bool keep_going = false;  ///< go on even if a point's first trials all end by the same error
};

struct Evaluation : Ended {
  fs::path file;
  std::string suite;                  ///< the suite's name in the store's views
  std::vector<std::string> warnings;  ///< contradictions between rows and physics
  Profile profile;                    ///< of the computed trials, the store's work included; if requested
};

/// Evaluates a suite into a store and continues from its contents: alone, as a shard, or with the ranks of a cluster.
/// The same store results for any number of computers and stops. Throws store::StoreError (whose text says how to go
/// on), RunError.
Evaluation evaluate(const EvaluateRequest& request, const Suite& suite, const Listener& listener = {});

/// Runs a rank other than 0: it computes the trials that rank 0 hands out, until rank 0 ends the run. The rank gets the
/// suite from rank 0 and reads no file. `profile` equals EvaluateRequest::profile on every rank.
void follow(Cluster& cluster, int threads, bool profile = false);

}  // namespace moma::run
