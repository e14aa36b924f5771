#include "eval/trial/key.h"

#include "eval/suite/sections.h"
#include "eval/trial/trial.h"

namespace moma {

using nlohmann::ordered_json;

TrialKeys::TrialKeys(const Point& point)
    : point_digest_(canonical_digest(ordered_json{
          {"version", kSimulationVersion},
          {"robot", point.robot_digest.empty() ? canonical_digest(point.robot->resolved) : point.robot_digest},
          {"controller", point.controller_resolved},
          {"simulation", to_json(point.simulation)},
          {"success", to_json(point.success)},
          {"stuck", to_json(point.stuck)},
          {"infeasible", to_json(point.infeasible)}})) {}

std::string TrialKeys::key(const ordered_json& world_identity) const {
  return canonical_digest(ordered_json{{"point", point_digest_}, {"world", world_identity}});
}

std::string trial_key(const Point& point, std::uint64_t world_index) {
  return TrialKeys(point).key(point.worlds.identity(world_index));
}

}  // namespace moma
