#pragma once

#include <Eigen/Core>
#include <vector>

namespace moma::fit {

template <int D>
struct Ball {
  Eigen::Matrix<double, D, 1> centre = Eigen::Matrix<double, D, 1>::Zero();
  double radius = 0.0;
};

/// Smallest enclosing ball (D = 3) or disc (D = 2) of at least one point, exact up to rounding; the radius reaches
/// every point. The problem is LP-type (Welzl, New Results and New Trends in Computer Science, 1991; Sharir and Welzl,
/// 1992): at most D + 1 points determine a ball. Starting with one point, the furthest point outside is added, and the
/// ball of these at most D + 2 points is found by trying all their subsets. Its radius grows with every step, so that
/// no subset repeats. About ten passes over the points.
template <int D>
Ball<D> smallest_ball(const std::vector<Eigen::Matrix<double, D, 1>>& points);

extern template Ball<2> smallest_ball<2>(const std::vector<Eigen::Matrix<double, 2, 1>>&);
extern template Ball<3> smallest_ball<3>(const std::vector<Eigen::Matrix<double, 3, 1>>&);

}  // namespace moma::fit
