#include "controller/task/vortex.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

constexpr double kFade = 0.1;      // the vortex fades within this distance of the goal [m]
constexpr double kNoticed = 0.02;  // S at which the side is chosen
constexpr double kTiny = 1e-9;

}  // namespace

void add_vortex(const VortexParams& params, std::span<const ProximityPair> pairs, std::span<const ObjectState> objects,
                const Vector3& e_p, int& circulation, Eigen::Ref<Vector3> nu) noexcept {
  const double way = e_p.norm();
  const double speed = nu.norm();
  if (!(way > kTiny) || !(speed > kTiny)) return;
  const Vector3 e = e_p / way;
  Vector3 sum = Vector3::Zero();
  double S = 0.0;
  for (const ProximityPair& pair : pairs) {
    if (pair.kind != PairKind::kObject || in_motion(objects[static_cast<std::size_t>(pair.second)])) continue;
    const Vector3& n = pair.distance.n_W;
    const double near = std::clamp(1.0 - pair.distance.d / params.distance, 0.0, 1.0);
    const double w = near * std::clamp(-n.dot(e), 0.0, 1.0) * std::min(1.0, way / kFade);
    const double flat = std::hypot(n.x(), n.y());
    if (!(w > 0.0) || !(flat > kTiny)) continue;
    sum += w / flat * Vector3(-n.y(), n.x(), 0.0);
    S += w;
  }
  if (!(S > 0.0)) return;
  if (circulation == 0) {
    if (S <= kNoticed) return;
    circulation = sum.dot(e) >= 0.0 ? 1 : -1;
  }
  const Vector3 u = nu / speed + params.gain * circulation * (sum / S) * std::min(S, 1.0);
  const double length = u.norm();
  if (length > kTiny) nu = speed / length * u;
}

}  // namespace moma
