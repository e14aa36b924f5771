#pragma once

#include <span>

#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/types.h"

namespace moma {

/// Turns the linear part of nu sideways along obstacles between E and its goal, with its length kept: circular fields
/// (Becker et al., arXiv 2210.16106 and 2306.16160) and circulation (Hu et al., doi 10.1109/TCST.2024.3372802), reduced
/// to the horizontal plane and to one direction for all obstacles. Moving objects do not count.
///
///   w_j = clip(1 - d_j/distance, 0, 1) clip(-n_j . e, 0, 1) min(1, |e_p|/0.1),   e = e_p/|e_p|
///   u = nu/|nu| + gain (sum w_j t_j / S) min(S, 1),   t_j = sigma (-n_y, n_x, 0)/|n_xy|,   S = sum w_j
///   nu <- |nu| u/|u|
///
/// @param e_p from E to the goal [m]
/// @param circulation sigma: chosen here as the sign of sum w_j t_j . e if it is 0 and S first exceeds 0.02
/// No allocation, no throw; a finite nu stays finite.
void add_vortex(const VortexParams& params, std::span<const ProximityPair> pairs, std::span<const ObjectState> objects,
                const Vector3& e_p, int& circulation, Eigen::Ref<Vector3> nu) noexcept;

}  // namespace moma
