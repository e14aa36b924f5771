#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "controller/fit/solid.h"

namespace moma::fit {

/// How hard to look: quick is for choosing among cuts (some percent off), thorough for what is written.
enum class Effort { kQuick, kThorough };

/// Shapes along the link's own axes are taken where they are at most so much larger than the smallest found: their
/// angles can be read, and symmetric meshes get symmetric shapes.
inline constexpr double kAlignedGain = 1.003;

/// Smallest enclosing sphere of at least one point: exact, see smallest_ball().
Solid enclosing_sphere(const Points& points);

/// An enclosing capsule of nearly least volume. For a given axis and radius the shortest length follows in closed form;
/// the search is over directions (spread over the half sphere, the link's and the principal axes, each with the
/// smallest disc around the projected points), then locally over all five variables: direction, offset, radius. A
/// radius above the smallest may pay, since it lets the caps do more of the covering.
Solid enclosing_capsule(const Points& points, Effort effort);

/// An enclosing box of nearly least volume. For a given normal the smallest rectangle around the projected points has
/// a side along an edge of their hull (Freeman and Shapira 1975), so that it is found exactly; normals are those of the
/// hull's faces, the link's and the principal axes and some spread over the half sphere. The best are improved by
/// taking the box's own axes for normals in turn (Chan and Tan 2001), then by small turns.
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
