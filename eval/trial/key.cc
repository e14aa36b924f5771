#include "eval/trial/key.h"

#include "eval/suite/sections.h"
#include "eval/trial/trial.h"
#include "world/sensing/disturbances_file.h"

namespace moma {

using nlohmann::ordered_json;

namespace {

std::string digest(const Point& point) {
  ordered_json json = {
      {"version", kSimulationVersion},
      {"robot", point.robot_digest.empty() ? canonical_digest(point.robot->resolved) : point.robot_digest},
      {"controller", point.controller_resolved},
      {"simulation", to_json(point.simulation)},
      {"success", to_json(point.success)},
      {"stuck", to_json(point.stuck)},
      {"infeasible", to_json(point.infeasible)}};
  if (any(point.disturbances)) json["disturbances"] = to_json(point.disturbances);
  return canonical_digest(json);
}

}  // namespace

TrialKeys::TrialKeys(const Point& point) : point_digest_(digest(point)) {}

std::string TrialKeys::key(const ordered_json& world_identity) const {
  return canonical_digest(ordered_json{{"point", point_digest_}, {"world", world_identity}});
}

std::string trial_key(const Point& point, std::uint64_t world_index) {
  return TrialKeys(point).key(point.worlds.identity(world_index));
}

}  // namespace moma
