#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "world/draws.h"
#include "world/world.h"

namespace moma {

/// Disturbed quantities. The values are part of a seed's meaning: never renumber them.
enum class DisturbanceSource : std::uint64_t {
  kJointNoise = 1,
  kJointVelocity = 2,
  kJointBias = 3,
  kBasePosition = 4,
  kBaseRotation = 5,
  kBaseLinear = 6,
  kBaseAngular = 7,
  kBaseBiasPosition = 8,
  kBaseBiasRotation = 9,
  kOdometryDistance = 10,
  kOdometryTurn = 11,
  kOdometryHeading = 12,
  kOdometryWalkPosition = 13,
  kOdometryWalkRotation = 14,
  kObjectPosition = 15,
  kObjectRotation = 16,
  kObjectLinear = 17,
  kObjectAngular = 18,
  kObjectBiasPosition = 19,
  kObjectBiasRotation = 20,
  kGoalPosition = 21,
  kGoalRotation = 22,
  kGoalLinear = 23,
  kGoalAngular = 24,
  kGoalBiasPosition = 25,
  kGoalBiasRotation = 26,
  kJointGain = 27,
  kBaseLinearGain = 28,
  kBaseAngularGain = 29,
  kJointFriction = 30,
  kPayloadMass = 31,
  kFloorFriction = 32,
  kJointArrival = 33,
  kBaseArrival = 34,
  kObjectArrival = 35,
  kGoalArrival = 36,
  kJointCommandArrival = 37,
  kBaseCommandArrival = 38,
  kObjectMissed = 39,
  kPhantom = 40,
  kOdometrySlip = 41,
  kMissedTick = 42,
  kDepthNoise = 43,
  kDepthArrival = 44
};

/// The draws of a trial's disturbances: a pure function of (the world's seed and index, `seed`, source, control step,
/// object), changed by the world's moves. WorldObject::noise identifies an object. Other disturbances, the number of
/// objects and the order of calls do not change a draw.
class DisturbanceStreams {
 public:
  DisturbanceStreams(const World& world, std::uint64_t seed)
      : world_seed_(world.seed), world_index_(world.index), seed_(seed), moves_(world.moves) {
    for (const WorldObject& object : world.objects)
      numbers_.push_back(object.noise >= 0 ? static_cast<std::size_t>(object.noise) : numbers_.size());
  }

  Draws sensing(DisturbanceSource source, long step, std::size_t object = 0) const {
    return draws(Stream::kSensing, source, step, object < numbers_.size() ? numbers_[object] : object);
  }
  Draws acting(DisturbanceSource source, long step = 0) const { return draws(Stream::kDisturbance, source, step, 0); }

 private:
  Draws draws(Stream stream, DisturbanceSource source, long step, std::size_t object) const {
    const std::uint64_t item =
        seed_ << 32 | static_cast<std::uint64_t>(object) << 8 | static_cast<std::uint64_t>(source);
    return {world_seed_, world_index_, stream, static_cast<std::uint64_t>(step), item, moves_.get()};
  }

  std::uint64_t world_seed_, world_index_, seed_;
  std::shared_ptr<const Moves> moves_;
  std::vector<std::size_t> numbers_;  ///< of the world's objects
};

}  // namespace moma
