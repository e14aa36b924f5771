#include "eval/search/nlopt_run.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <exception>
#include <nlopt.hpp>
#include <stdexcept>

#include "controller/config/node.h"

namespace moma::tune {
namespace {

constexpr std::array kAlgorithms{
    AlgorithmInfo{"GN_CRS2_LM", true, true},    // controlled random search with local mutation
    AlgorithmInfo{"GN_DIRECT_L", true, false},  // dividing rectangles, biased to local search
    AlgorithmInfo{"LN_BOBYQA", false, false},   // quadratic models
    AlgorithmInfo{"LN_SBPLX", false, false},    // Nelder-Mead on subspaces
};

}  // namespace

std::span<const AlgorithmInfo> algorithms() { return kAlgorithms; }

const AlgorithmInfo& find_algorithm(std::string_view name) {
  std::string wanted(name);
  for (char& c : wanted) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::vector<std::string> known;
  for (const AlgorithmInfo& info : kAlgorithms) {
    if (info.name == wanted || info.name.substr(3) == wanted) return info;
    known.emplace_back(info.name.substr(3));
  }
  throw std::invalid_argument(fmt::format("unknown algorithm '{}'{}; known are {}", name,
                                          config::suggestion(wanted, known), fmt::join(known, ", ")));
}

namespace {

// First and last step of local algorithms in the unit cube.
constexpr double kInitialStep = 0.2, kTolerance = 0.004;

// NLopt calls back through C, which exceptions must not cross: they are stored here.
struct Callback {
  const UnitFunction* function = nullptr;
  std::exception_ptr error;
  bool stopped = false;
};

/// Known costs are asked for as well: the function then ends a search that proposes known points only. CRS2, for one,
/// proposes the same point for ever once its whole population lies at a bound.
double cost(const std::vector<double>& x, std::vector<double>& /*gradient*/, void* data) {
  auto& callback = *static_cast<Callback*>(data);
  if (!callback.stopped) {
    try {
      if (const std::optional<double> told = (*callback.function)(x)) return *told;
    } catch (...) {
      callback.error = std::current_exception();
    }
    callback.stopped = true;
  }
  throw nlopt::forced_stop();
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

}  // namespace

std::string run_nlopt(const NloptRun& run, const UnitFunction& function) {
  const auto n = static_cast<unsigned>(run.start.size());
  nlopt::srand(static_cast<unsigned long>(run.seed));
  nlopt::opt opt(nlopt_algorithm_of(*run.algorithm), n);
  opt.set_lower_bounds(0.0);
  opt.set_upper_bounds(1.0);
  if (!run.algorithm->global) {
    opt.set_initial_step(kInitialStep);
    opt.set_xtol_abs(kTolerance);
  }
  if (run.population > 0) opt.set_population(static_cast<unsigned>(run.population));

  Callback callback;
  callback.function = &function;
  opt.set_min_objective(cost, &callback);

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
