#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "controller/fit/placed.h"

namespace moma::fit {

/// Quick searches compare cuts (some percent off); thorough ones give the result.
enum class Effort { kQuick, kThorough };

/// Factor by which a shape along the link's own axes may be larger than the smallest: its angles are readable.
inline constexpr double kAlignedGain = 1.003;

/// Smallest enclosing sphere of at least one point: exact, see smallest_ball().
Solid enclosing_sphere(const Points& points);

/// Returns an enclosing capsule of nearly least volume. The length for an axis and a radius is a closed form. The
/// search compares directions (over the half sphere, the link's and the principal axes, each with the smallest disc
/// around the projected points), then varies direction, offset and radius locally. A larger radius may pay: its caps
/// cover more.
Solid enclosing_capsule(const Points& points, Effort effort);

/// Returns an enclosing box of nearly least volume. For a given normal the smallest rectangle around the projected
/// points has a side along an edge of their hull (Freeman and Shapira 1975). The search compares normals (of the hull's
/// faces, the link's and the principal axes, over the half sphere), then uses the best boxes' own axes as normals in
/// turn (Chan and Tan 2001), then small rotations.
Solid enclosing_box(const Points& points, Effort effort);

/// Start, first step and box of each variable of minimise().
struct Variables {
  std::vector<double> start;
  std::vector<double> step;
  std::vector<double> lower;
  std::vector<double> upper;
};

/// Returns a local minimum of f, which may have kinks, by Subplex (Rowan 1990, NLopt's LN_SBPLX): no derivatives, no
/// random numbers, never worse than the start. f must not throw.
std::vector<double> minimise(const std::function<double(const std::vector<double>&)>& f, const Variables& variables,
                             int evaluations);

template <int D>
struct Ball {
  Eigen::Matrix<double, D, 1> centre = Eigen::Matrix<double, D, 1>::Zero();
  double radius = 0.0;
};

/// Smallest enclosing ball (D = 3) or disc (D = 2) of at least one point, exact to rounding; the radius reaches every
/// point. D + 1 points or fewer determine it (Welzl 1991; Sharir and Welzl 1992). Starting from one point, the furthest
/// point outside enters, and the ball of these D + 2 points at most is found by trying all their subsets. Its radius
/// grows with every step. About ten passes over the points.
template <int D>
Ball<D> smallest_ball(const std::vector<Eigen::Matrix<double, D, 1>>& points);

extern template Ball<2> smallest_ball<2>(const std::vector<Eigen::Matrix<double, 2, 1>>&);
extern template Ball<3> smallest_ball<3>(const std::vector<Eigen::Matrix<double, 3, 1>>&);

}  // namespace moma::fit
