#include "eval/trial/key.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "eval/trial/spec_file.h"
#include "eval/trial/trial.h"
#include "world/sensing/disturbances_file.h"

namespace moma {
namespace {

std::string digest(const TrialSpec& spec) {
  Json json = {{"version", kSimulationVersion},
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

std::string TrialKeys::key(const Json& world_identity) const {
  return canonical_digest(Json{{"point", spec_digest_}, {"world", world_identity}});
}

std::string digest_hex(std::string_view text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string canonical_digest(const Json& json) {
  // nlohmann::json, unlike Json, keeps an object's keys sorted.
  return digest_hex(nlohmann::json(json).dump());
}

}  // namespace moma
