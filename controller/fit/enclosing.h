#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "controller/fit/placed.h"

namespace moma::fit {

/// Effort of a search: quick for comparing cuts (some percent off), thorough for the result.
enum class Effort { kQuick, kThorough };

/// A shape along the link's own axes is preferred if it is at most this factor larger than the smallest: its angles are
/// readable, and symmetric meshes get symmetric shapes.
inline constexpr double kAlignedGain = 1.003;

/// Smallest enclosing sphere of at least one point: exact, see smallest_ball().
Solid enclosing_sphere(const Points& points);

/// Returns an enclosing capsule of nearly least volume. The shortest length for a given axis and radius is a closed
/// form. The search covers directions (spread over the half sphere, the link's and the principal axes, each with the
/// smallest disc around the projected points), then locally all five variables: direction, offset, radius. A radius
/// above the smallest may pay, since the caps then cover more.
Solid enclosing_capsule(const Points& points, Effort effort);

/// Returns an enclosing box of nearly least volume. For a given normal the smallest rectangle around the projected
/// points has a side along an edge of their hull (Freeman and Shapira 1975) and is found exactly. Normals are those of
/// the hull's faces, the link's and the principal axes, and some spread over the half sphere. The best boxes are
/// improved by using the box's own axes as normals in turn (Chan and Tan 2001), then by small rotations.
Solid enclosing_box(const Points& points, Effort effort);

/// What minimise() varies: start, first step and box of each variable.
struct Variables {
  std::vector<double> start;
  std::vector<double> step;
  std::vector<double> lower;
  std::vector<double> upper;
};

/// A point near `start` where f is smallest, for functions with kinks: Subplex (Rowan 1990, NLopt's LN_SBPLX), which
/// needs no derivatives and draws no random numbers. Never worse than the start. f must not throw.
std::vector<double> minimise(const std::function<double(const std::vector<double>&)>& f, const Variables& variables,
                             int evaluations);

template <int D>
struct Ball {
  Eigen::Matrix<double, D, 1> centre = Eigen::Matrix<double, D, 1>::Zero();
  double radius = 0.0;
};

/// Smallest enclosing ball (D = 3) or disc (D = 2) of at least one point, exact to rounding; the radius reaches every
/// point. The problem is LP-type (Welzl, New Results and New Trends in Computer Science, 1991; Sharir and Welzl, 1992):
/// a ball is set by D + 1 points or fewer. Starting from one point, the furthest point outside enters, and the ball of
/// these D + 2 points at most is found by trying all their subsets; its radius grows with every step, so that no subset
/// comes twice. About ten passes over the points.
template <int D>
Ball<D> smallest_ball(const std::vector<Eigen::Matrix<double, D, 1>>& points);

extern template Ball<2> smallest_ball<2>(const std::vector<Eigen::Matrix<double, 2, 1>>&);
extern template Ball<3> smallest_ball<3>(const std::vector<Eigen::Matrix<double, 3, 1>>&);

}  // namespace moma::fit
