#include "eval/cli/time_known.h"

#include "eval/run/time_known.h"

namespace moma::cli {

std::optional<double> time_known(const reports::HitObject& question) {
  return run::known_before_contact({question.world, question.disturbances, question.object, question.control_period,
                                    question.contact_time, question.t, question.base});
}

}  // namespace moma::cli
