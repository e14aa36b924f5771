#include "eval/cli/stored_case.h"

#include <stdexcept>

#include "eval/cli/command.h"
#include "eval/store/reader.h"
#include "eval/trial/case_of_step.h"

namespace moma::cli {

ControlCase stored_case(run::StoredSuites& suites, const std::filesystem::path& db, const std::string& trial,
                        long step) {
  const store::StoredTrial stored = store::Reader(db).trial(trial);
  try {
    return case_of_step(suites.point_of(stored), run::world_of(stored), step);
  } catch (const std::invalid_argument& e) {
    throw UsageError(e.what());
  }
}

}  // namespace moma::cli
