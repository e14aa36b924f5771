#include "controller/safe/object_memory.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace moma {
namespace {

// Does not own the model, which must live as long.
std::shared_ptr<const RobotModel> borrowed(const RobotModel& model) { return {std::shared_ptr<void>(), &model}; }

}  // namespace

ObjectMemory::ObjectMemory(const RobotModel& model, const MemoryParams& params, double control_period)
    : params_(params), dt_(control_period), robot_(borrowed(model)), frames_(model, control_period) {}

void ObjectMemory::set_objects(std::span<const ObjectShape> objects) {
  std::vector<Shape> shapes;
  for (const ObjectShape& object : objects) shapes.push_back(object.shape);
  frames_.set_objects(shapes);
}

bool ObjectMemory::believes(const PoseTrack& track) const noexcept {
  if (!on() || track.seen == 0) return false;
  if (track.moving || !frames_.any()) return track.unseen + dt_ <= params_.keep;
  return track.passed < std::min(params_.gone, track.seen * dt_);
}

void ObjectMemory::look(const Observation& told, std::span<const ObjectState> believed,
                        std::span<PoseTrack> tracks) noexcept {
  if (!on() || !frames_.any()) return;
  const auto from_memory = [&](std::size_t i) { return believed[i].visible && !told.objects[i].visible; };
  bool any = false;
  for (std::size_t i = 0; i < believed.size() && !any; ++i) any = from_memory(i);
  if (!any) return;
  robot_.place(told.base, told.q);
  frames_.look(std::lround(told.time / dt_), robot_, believed);
  for (std::size_t i = 0; i < believed.size(); ++i) {
    if (!from_memory(i)) continue;
    double longest = 0.0;
    for (int sensor = 0; sensor < frames_.count(); ++sensor)
      if (frames_.due(sensor) && frames_.rays_on(sensor, i) >= params_.rays)
        longest = std::max(longest, frames_.interval(sensor));
    tracks[i].passed += longest;
  }
}

}  // namespace moma
