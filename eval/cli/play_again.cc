#include "eval/cli/play_again.h"

#include "eval/store/samples.h"

namespace moma::cli {

std::optional<reports::OwnedSamples> play_again(run::StoredSuites& suites, const std::filesystem::path& db,
                                                const std::string& trial) {
  const run::Replay replay = run::replay(db, trial, suites);
  if (replay.output.trace.empty()) return {};
  store::EncodedSamples encoded = store::encode_samples(replay.output.trace);
  return reports::OwnedSamples{encoded.layout, encoded.n, store::column_names_of(encoded.columns),
                               std::move(encoded.data)};
}

}  // namespace moma::cli
