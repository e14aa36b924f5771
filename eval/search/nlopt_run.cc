#include "eval/search/nlopt_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <nlopt.hpp>
#include <stdexcept>

namespace moma::tune {
namespace {

// Evaluations per variable of each inner search of MLSL and AUGLAG, which start many of them.
constexpr int kInnerEvaluations = 12;

// NLopt calls back through C, which exceptions must not cross: they are stored here.
struct Callback {
  const UnitFunction* function = nullptr;
  std::exception_ptr error;
  bool stopped = false;
  std::vector<double> last_x;
  Told last;

  /// Returns the constraints at the point just evaluated.
  const Told* constraints_at(const std::vector<double>& x) { return !stopped && x == last_x ? &last : at(x); }

  /// Asks for every cost, known or not. The function ends searches that meet only known points: CRS2 with its whole
  /// population at a bound asks for the same point for ever.
  const Told* at(const std::vector<double>& x) {
    if (stopped) return nullptr;
    try {
      std::optional<Told> told = (*function)(x);
      if (!told) {
        stopped = true;
        return nullptr;
      }
      last_x = x;
      last = std::move(*told);
      return &last;
    } catch (...) {
      error = std::current_exception();
      stopped = true;
      return nullptr;
    }
  }
};

struct ConstraintCallback {
  Callback* callback = nullptr;
  std::size_t index = 0;
};

double cost(const std::vector<double>& x, std::vector<double>& /*gradient*/, void* data) {
  const Told* told = static_cast<Callback*>(data)->at(x);
  if (told == nullptr) throw nlopt::forced_stop();
  return told->value;
}

double constraint(const std::vector<double>& x, std::vector<double>& /*gradient*/, void* data) {
  const auto& which = *static_cast<ConstraintCallback*>(data);
  const Told* told = which.callback->constraints_at(x);
  if (told == nullptr) throw nlopt::forced_stop();
  return told->constraints[which.index];
}

nlopt::algorithm nlopt_algorithm_of(const AlgorithmInfo& info) {
  const nlopt_algorithm found = nlopt_algorithm_from_string(std::string(info.name).c_str());
  if (static_cast<int>(found) < 0) {
    throw std::invalid_argument(fmt::format("this NLopt has no algorithm {}", info.name));
  }
  return static_cast<nlopt::algorithm>(found);
}

std::string describe(nlopt::result result) {
  switch (result) {
    case nlopt::XTOL_REACHED:
      return "converged";
    case nlopt::FTOL_REACHED:
      return "converged (value)";
    case nlopt::MAXEVAL_REACHED:
      return "most evaluations reached";
    case nlopt::SUCCESS:
      return "finished";
    default:
      return "ended";
  }
}

void set_local_stops(nlopt::opt& opt, const NloptRun& run) {
  opt.set_initial_step(run.initial_step);
  opt.set_xtol_abs(run.tolerance);
}

}  // namespace

std::string run_nlopt(const NloptRun& run, const UnitFunction& function) {
  const auto n = static_cast<unsigned>(run.start.size());
  nlopt::srand(static_cast<unsigned long>(run.seed));
  nlopt::opt opt(nlopt_algorithm_of(*run.algorithm), n);
  opt.set_lower_bounds(0.0);
  opt.set_upper_bounds(1.0);
  if (!run.algorithm->global) set_local_stops(opt, run);
  if (run.algorithm->needs_local && run.inner != nullptr) {
    nlopt::opt local(nlopt_algorithm_of(*run.inner), n);
    set_local_stops(local, run);
    local.set_maxeval(kInnerEvaluations * static_cast<int>(n));
    opt.set_local_optimizer(local);
  }
  if (run.algorithm->has_population && run.population > 0) {
    opt.set_population(static_cast<unsigned>(run.population));
  }

  Callback callback;
  callback.function = &function;
  opt.set_min_objective(cost, &callback);
  std::vector<ConstraintCallback> constraints(run.constraints);
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    constraints[k] = {&callback, k};
    opt.add_inequality_constraint(constraint, &constraints[k], 1e-9);
  }

  std::vector<double> x = run.start;
  double value = std::numeric_limits<double>::infinity();
  std::string why;
  try {
    why = describe(opt.optimize(x, value));
  } catch (const nlopt::forced_stop&) {
    why = "budget spent";
  } catch (const nlopt::roundoff_limited&) {
    why = "converged (rounding)";
  } catch (const std::invalid_argument& e) {
    if (!callback.error)
      throw std::invalid_argument(fmt::format("NLopt refused {}: {}", run.algorithm->name, e.what()));
  } catch (const std::runtime_error& e) {
    // Some algorithms end by a generic failure when the simplex or trust region degenerates.
    why = fmt::format("gave up ({})", e.what());
  }
  if (callback.error) std::rethrow_exception(callback.error);
  return callback.stopped ? "budget spent" : why;
}

}  // namespace moma::tune
