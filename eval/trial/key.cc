#include "eval/trial/key.h"

#include <fmt/format.h>
#include <xxhash.h>

#include "eval/trial/spec_file.h"
#include "eval/trial/trial.h"

namespace moma {
namespace {

std::string digest(const TrialSpec& spec) {
  Json json = sections_json(spec);
  json["version"] = kSimulationVersion;
  json["robot"] = spec.robot_digest.empty() ? canonical_digest(spec.robot->resolved) : spec.robot_digest;
  json["controller"] = spec.controller_resolved;
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
