#include "controller/plan/tuck.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "controller/plan/counted_draws.h"

namespace moma {
namespace {

constexpr int kDraws = 500, kWide = 200;
constexpr double kWideSteps = 0.8, kSteps = 0.25;  // [rad]
constexpr int kDirections = 12;
constexpr std::uint64_t kKey = 77;

// Weighs the farthest shape most, then the sum of all, then the distance from `ready`.
double sprawl(const RobotModel& model, const Kinematics& kinematics, const Eigen::Ref<const VectorX>& q) {
  constexpr double kAll = 0.02, kChange = 0.02;
  double farthest = 0.0, sum = 0.0;
  for (const CollisionShape& shape : model.present_shapes()) {
    if (shape.rigid_with_base) continue;
    double reach = 0.0;
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kDirections;
      reach =
          std::max(reach, extent_along(shape.shape, kinematics.X_WS(shape), {std::cos(angle), std::sin(angle), 0.0}));
    }
    farthest = std::max(farthest, reach);
    sum += reach;
  }
  return farthest + kAll * sum + kChange * (q - model.ready).norm();
}

}  // namespace

VectorX tucked_arm(const RobotModel& model, FreeSpace& space, const Clearances& clearances) {
  VectorX best = model.ready;
  if (!model.mobile()) return best;
  const MotionLimits& limits = space.limits();
  const int joints = limits.num_joints();
  WholeConfiguration c = WholeConfiguration::Zero(3 + joints);
  c.tail(joints) = best;
  // Some links are nearer to each other than that in every configuration.
  space.set_clearances({-1.0, clearances.floor, clearances.self}, c);
  const Clearances kept = space.clearances();
  const auto cost = [&] {
    if (!space.clear(c, kept)) return kInfinity;
    return sprawl(model, space.kinematics(), c.tail(joints));
  };
  double least = cost();
  CountedDraws draws{kKey, 0};
  for (int k = 0; k < kDraws; ++k) {
    const double width = k < kWide ? kWideSteps : kSteps;
    for (int i = 0; i < joints; ++i) {
      const double margin = std::min(0.4, 0.2 * (limits.upper[i] - limits.lower[i]));
      const bool moved = draws.uniform() < 0.5;
      const double by = draws.uniform(-width, width);
      c[3 + i] = std::clamp(best[i] + (moved ? by : 0.0), limits.lower[i] + margin, limits.upper[i] - margin);
    }
    const double now = cost();
    if (now >= least) continue;
    least = now;
    best = c.tail(joints);
  }
  return best;
}

}  // namespace moma
