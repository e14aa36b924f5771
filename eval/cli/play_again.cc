#include "eval/cli/play_again.h"

#include <nlohmann/json.hpp>

#include "eval/store/samples.h"
#include "eval/trial/trial.h"

namespace moma::cli {

std::optional<reports::OwnedSamples> play_again(StoredSuites& suites, const std::filesystem::path& db,
                                                const std::string& trial) {
  const store::StoredTrial stored = store::Reader(db).trial(trial);
  const TrialOutput output = run_trial(suites.point_of(stored), world_of(stored));
  if (output.trace.empty()) return {};
  store::EncodedSamples encoded = store::encode_samples(output.trace);
  return reports::OwnedSamples{encoded.layout, encoded.n,
                               nlohmann::json::parse(encoded.columns).get<std::vector<std::string>>(),
                               std::move(encoded.data)};
}

}  // namespace moma::cli
