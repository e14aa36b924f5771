#include "eval/trial/key.h"

#include "eval/trial/digest.h"
#include "eval/trial/spec_file.h"
#include "eval/trial/trial.h"
#include "world/sensing/disturbances_file.h"

namespace moma {

using nlohmann::ordered_json;

namespace {

std::string digest(const TrialSpec& spec) {
  ordered_json json = {
      {"version", kSimulationVersion},
      {"robot", spec.robot_digest.empty() ? canonical_digest(spec.robot->resolved) : spec.robot_digest},
      {"controller", spec.controller_resolved},
      {"simulation", to_json(spec.simulation)},
      {"success", to_json(spec.success)},
      {"stuck", to_json(spec.stuck)},
      {"infeasible", to_json(spec.infeasible)}};
  if (any(spec.disturbances)) json["disturbances"] = to_json(spec.disturbances);
  return canonical_digest(json);
}

}  // namespace

TrialKeys::TrialKeys(const TrialSpec& spec) : spec_digest_(digest(spec)) {}

std::string TrialKeys::key(const ordered_json& world_identity) const {
  return canonical_digest(ordered_json{{"point", spec_digest_}, {"world", world_identity}});
}

}  // namespace moma
