#include "controller/fit/enclosing.h"

#include <exception>
#include <functional>
#include <new>
#include <nlopt.hpp>
#include <vector>

namespace moma::fit {
namespace {

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
