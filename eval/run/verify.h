#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "eval/run/listener.h"
#include "eval/run/replay.h"
#include "eval/store/contents.h"
#include "eval/store/reader.h"

namespace moma::run {

struct VerifyRequest : Request {
  std::string point;      ///< replays trials of this one alone (eval/run/named_point.h); "": of all
  std::string suite;      ///< of `point`, where several have it
  double fraction = 0.1;  ///< of the trials; at least one unless 0
  std::int64_t seed = 1;  ///< chooses other trials
  Plugins plugins = Plugins::kRefused;
};

struct Verification {
  std::size_t trials = 0;  ///< in the store
  std::size_t chosen = 0;  ///< for a replay
  std::size_t replayed = 0;
  std::size_t findings = 0;  ///< each is passed to Listener::warning at once
  store::ContentCounts contents;
  std::size_t points = 0;                ///< built again and compared with their rows
  std::vector<std::string> not_checked;  ///< parts without a check, in words
  std::vector<std::string> in_doubt;     ///< checks that were not possible: the store is then not sound
  std::size_t searches = 0;              ///< run again over their stored trials (verify_searches())
  std::size_t verdicts = 0;              ///< searches whose verdict was computed again
  /// Number of replayed trials, by column, whose stored row has no value and whose replay has one.
  std::map<std::string_view, std::size_t> missing;
  std::string hash;  ///< over every result: equal hashes mean equal rows
  End end = End::kFinished;

  /// True if trials were chosen and none could be replayed.
  bool in_vain() const { return chosen > 0 && replayed == 0 && end == End::kFinished; }
};

/// Looks for damage, compares everything that the store says twice (eval/store/contents.h), builds the points and keys
/// of all trials again, and replays a fraction of them: rows, metrics and samples must come out bit for bit. Searches
/// are run again over their trials. Throws store::StoreError.
Verification verify(const VerifyRequest& request, const Listener& listener = {});

/// The part of verify() about searches (moma tune): repeats every one of the store. The candidates must be the same,
/// their costs must follow from the stored trials, of which the chosen ones are simulated again, and so must the
/// verdict from the stored trials of the held-out worlds. Every row of the tables tune_* must be reproduced. Adds to
/// `found`; `finding` gets a sentence for each disagreement. Throws store::StoreError.
void verify_searches(const store::Reader& reader, const VerifyRequest& request, const std::set<std::string>& chosen,
                     const Listener::Text& finding, Verification& found);

}  // namespace moma::run
