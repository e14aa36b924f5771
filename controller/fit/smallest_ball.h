#pragma once

#include <Eigen/Core>
#include <vector>

namespace moma::fit {

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
