#include "controller/ahead/candidates.h"

#include <array>
#include <numbers>

#include "controller/task/escape.h"
#include "controller/task/servo.h"

namespace moma {
namespace {

constexpr std::array<double, 7> kAngles{0.8, -0.8, 1.6, -1.6, 2.4, -2.4, std::numbers::pi};  // from the goal's [rad]
constexpr std::array<double, 2> kLengths{0.5, 1.3};                                          // from the base [m]
constexpr double kSpeed = 0.7, kMore = 0.8;  // a detour may last its length at this speed [m/s], and more [s]
static_assert(kCandidates == kFirstDetour + kAngles.size() * kLengths.size());

}  // namespace

Detour detour_of(int index) noexcept {
  const auto k = static_cast<std::size_t>(index - kFirstDetour);
  return {kAngles[k % kAngles.size()], kLengths[k / kAngles.size()]};
}

EscapeState candidate(const EscapeParams& params, const Kinematics& kinematics, const GoalState& goal,
                      int index) noexcept {
  EscapeState state;
  if (index < kVortices) {
    state.circulation = index == 0 ? 1 : -1;
    return state;
  }
  if (index < kFirstDetour) {
    state.best = remaining_way(params, pose_error(kinematics.X_WE(), goal.X_WG));
    state.idle = params.patience;
    return state;
  }
  const auto [angle, length] = detour_of(index);
  const Vector3 p_WE = kinematics.X_WE().translation();
  const bool mobile = kinematics.model().mobile();
  const Vector3 from = kinematics.X_WL(mobile ? 0 : 1).translation();
  const Vector3 e_h = heading(goal.X_WG.translation() - p_WE, kinematics.X_WB().linear().col(0));
  state.detour = true;
  state.target_W = from + length * (Eigen::AngleAxisd(angle, Vector3::UnitZ()) * e_h);
  state.target_W.z() = p_WE.z();
  state.remaining = kMore + length / kSpeed;
  return state;
}

}  // namespace moma
