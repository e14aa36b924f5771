#include <nlopt.hpp>

#include <Eigen/LU>
#include <cmath>
#include <exception>
#include <limits>
#include <new>
#include <utility>

#include "controller/fit/enclosing.h"

namespace moma::fit {
namespace {

constexpr double kRounding = 1e-12;  // relative to the radius
constexpr int kMostSteps = 1000;     // rounding could otherwise let subsets repeat

template <int D>
using Point = Eigen::Matrix<double, D, 1>;

// The smallest ball with all `points` on its boundary; false unless they are in general position. The centre c = p0 +
// sum l_i v_i, v_i = p_i - p0, has the same distance to all: V^T V l = 1/2 diag(V^T V).
template <int D>
bool ball_through(const std::vector<Point<D>>& points, Ball<D>& ball) {
  const auto spanned = static_cast<Eigen::Index>(points.size()) - 1;
  ball.centre = points[0];
  ball.radius = 0.0;
  if (spanned == 0) return true;
  Eigen::Matrix<double, D, Eigen::Dynamic, 0, D, D + 1> v(D, spanned);
  for (Eigen::Index i = 0; i < spanned; ++i) v.col(i) = points[static_cast<std::size_t>(i + 1)] - points[0];
  const Eigen::MatrixXd gram = v.transpose() * v;
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(gram);
  if (!lu.isInvertible()) return false;
  const Point<D> offset = v * lu.solve(0.5 * gram.diagonal());
  ball.centre += offset;
  ball.radius = offset.norm();
  return offset.allFinite();
}

template <int D>
double reach(const Ball<D>& ball, const std::vector<Point<D>>& points, std::size_t* furthest = nullptr) {
  double most = -1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double squared = (points[i] - ball.centre).squaredNorm();
    if (squared > most) {
      most = squared;
      if (furthest != nullptr) *furthest = i;
    }
  }
  return std::sqrt(most);
}

// Smallest ball of a few points: the smallest among the balls of their subsets that reach all points. `support` becomes
// the subset.
template <int D>
Ball<D> ball_of_few(std::vector<Point<D>>& support) {
  Ball<D> best;
  best.radius = std::numeric_limits<double>::infinity();
  std::vector<Point<D>> best_subset;
  for (unsigned mask = 1; mask < (1U << support.size()); ++mask) {
    std::vector<Point<D>> subset;
    for (std::size_t i = 0; i < support.size(); ++i)
      if ((mask >> i & 1U) != 0) subset.push_back(support[i]);
    Ball<D> ball;
    if (subset.size() > D + 1 || !ball_through<D>(subset, ball) || ball.radius >= best.radius) continue;
    if (reach<D>(ball, support) > ball.radius * (1.0 + kRounding)) continue;
    best = ball;
    best_subset = std::move(subset);
  }
  support = std::move(best_subset);
  return best;
}

struct Problem {
  const std::function<double(const std::vector<double>&)>* f = nullptr;
  double least = 0.0;
  std::vector<double> best;
};

double value(const std::vector<double>& x, std::vector<double>& /*gradient*/, void* data) {
  auto& problem = *static_cast<Problem*>(data);
  const double y = (*problem.f)(x);
  if (y < problem.least) {
    problem.least = y;
    problem.best = x;
  }
  return y;
}

}  // namespace

template <int D>
Ball<D> smallest_ball(const std::vector<Point<D>>& points) {
  Ball<D> ball;
  ball.centre = points[0];
  std::vector<Point<D>> support{points[0]};
  for (int step = 0; step < kMostSteps; ++step) {
    std::size_t furthest = 0;
    const double reached = reach<D>(ball, points, &furthest);
    if (reached <= ball.radius * (1.0 + kRounding)) break;
    support.push_back(points[furthest]);
    const Ball<D> next = ball_of_few<D>(support);
    if (!(next.radius > ball.radius) || support.empty()) break;
    ball = next;
  }
  ball.radius = reach<D>(ball, points);
  return ball;
}

template Ball<2> smallest_ball<2>(const std::vector<Point<2>>&);
template Ball<3> smallest_ball<3>(const std::vector<Point<3>>&);

std::vector<double> minimise(const std::function<double(const std::vector<double>&)>& f, const Variables& variables,
                             int evaluations) {
  Problem problem{&f, f(variables.start), variables.start};
  nlopt::opt search(nlopt::LN_SBPLX, static_cast<unsigned>(variables.start.size()));
  search.set_min_objective(value, &problem);
  search.set_lower_bounds(variables.lower);
  search.set_upper_bounds(variables.upper);
  search.set_initial_step(variables.step);
  search.set_xtol_rel(1e-6);
  search.set_ftol_rel(1e-7);
  search.set_maxeval(evaluations);
  std::vector<double> x = variables.start;
  double y = 0.0;
  try {
    search.optimize(x, y);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    // A rounding error, for example, ended the search: the best point so far is kept.
  }
  return problem.best;
}

}  // namespace moma::fit
