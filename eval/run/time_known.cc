#include "eval/run/time_known.h"

#include <algorithm>

#include "controller/config/json_node.h"
#include "controller/config/node.h"
#include "world/sensing/detection.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma::run {

std::optional<double> known_before_contact(const CollisionCase& collision) {
  const World world = world_from_json(config::parse_json(collision.world, "world"), "world");
  const Disturbances disturbances =
      read_disturbances(config::parse_yaml(collision.disturbances, "disturbances"), "disturbances");
  const auto hit = std::find_if(world.objects.begin(), world.objects.end(),
                                [&](const WorldObject& object) { return object.name == collision.object; });
  const DetectionRule& rule = disturbances.detection;
  if (rule.occlusion || rule.mount == SensorMount::kHand || rule.seen_by == SeenBy::kSensors)
    return {};  // samples without a base do not contain the arm's motion
  Detection detection(rule, world, DisturbanceStreams(world, disturbances.seed), collision.control_period);
  if (hit == world.objects.end() || !detection.on()) return {};
  const auto place = static_cast<std::size_t>(hit - world.objects.begin());
  std::vector<ObjectState> states(world.objects.size());
  for (std::size_t k = 0; k < collision.t.size(); ++k) {
    const double* base = collision.base.data() + 3 * k;
    object_states(world, collision.t[k], states);
    for (ObjectState& state : states) state.visible = true;
    detection.update(static_cast<long>(k), {base[0], base[1], base[2]}, {}, states);
    if (!states[place].visible) continue;
    // An object known from the start has no detection time.
    const double since = k == 0 ? 0.0 : collision.t[k] + disturbances.objects.delay;
    return std::max(0.0, collision.contact_time - since);
  }
  return 0.0;
}

}  // namespace moma::run
