// Where the time of a dynamic trial goes: ODE, the controller, everything else.
//
//   moma_bench_trial_shares SUITE [TRIALS]
//
// Calls into ODE and into the controller are timed from outside: this program's dWorldStep, dSpaceCollide2 and
// dCollide stand before the library's own.
#include <dlfcn.h>
#include <fmt/format.h>
#include <ode/ode.h>

#include <chrono>
#include <map>
#include <string>

#include "bench/suite_program.h"
#include "controller/controller.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"

namespace {

using Clock = std::chrono::steady_clock;

double ode_seconds = 0.0;
int depth = 0;

/// Counts the outermost of nested calls.
class Timed {
 public:
  Timed() : start_(depth++ == 0 ? Clock::now() : Clock::time_point()) {}
  ~Timed() {
    if (--depth == 0) ode_seconds += std::chrono::duration<double>(Clock::now() - start_).count();
  }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  Clock::time_point start_;
};

template <typename Function>
Function* library(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int dWorldStep(dWorldID world, dReal h) {
  static auto* const real = library<int(dWorldID, dReal)>("dWorldStep");
  const Timed timed;
  return real(world, h);
}

void dSpaceCollide2(dGeomID a, dGeomID b, void* data, dNearCallback* near) {
  static auto* const real = library<void(dGeomID, dGeomID, void*, dNearCallback*)>("dSpaceCollide2");
  const Timed timed;
  real(a, b, data, near);
}

int dCollide(dGeomID a, dGeomID b, int flags, dContactGeom* contact, int skip) {
  static auto* const real = library<int(dGeomID, dGeomID, int, dContactGeom*, int)>("dCollide");
  const Timed timed;
  return real(a, b, flags, contact, skip);
}

}  // extern "C"

namespace moma {
namespace {

class TimedController final : public StepController {
 public:
  TimedController(const TrialSpec& point, double& seconds)
      : controller_(point.robot->model, point.controller_params, point.simulation.control_period), seconds_(seconds) {}

  void reset(std::span<const ObjectShape> objects) override { controller_.reset(objects); }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    const Clock::time_point start = Clock::now();
    controller_.step(observation, result);
    seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
  }

 private:
  Controller controller_;
  double& seconds_;
};

struct Shares {
  int trials = 0;
  double total = 0.0, ode = 0.0, controller = 0.0, worlds = 0.0;
};

Shares& operator+=(Shares& sum, const Shares& more) {
  sum.trials += more.trials;
  sum.total += more.total;
  sum.ode += more.ode;
  sum.controller += more.controller;
  sum.worlds += more.worlds;
  return sum;
}

Shares measure(const SuitePoint& point, std::uint64_t index, std::string& family) {
  Shares out;
  out.trials = 1;
  ode_seconds = 0.0;
  TrialParts parts;
  parts.controller = [&out](const TrialSpec& p) { return std::make_unique<TimedController>(p, out.controller); };
  const Clock::time_point start = Clock::now();
  const World world = point.worlds.make(point.robot->model, index);
  const Clock::time_point made = Clock::now();
  family = world.family;
  run_trial(point, world, parts);
  out.worlds = std::chrono::duration<double>(made - start).count();
  out.total = std::chrono::duration<double>(Clock::now() - start).count();
  out.ode = ode_seconds;
  return out;
}

void run(const std::string& file, std::uint64_t trials) {
  const Suite suite = load_suite(file);
  std::map<std::string, Shares> table;
  for (const SuitePoint& point : suite.points) {
    for (std::uint64_t i = 0; i < trials; ++i) {
      std::string family;
      const Shares shares = measure(point, i, family);
      table[fmt::format("{:<16} {:<10}", point.controller, family)] += shares;
      table[fmt::format("{:<16} {:<10}", point.controller, "all")] += shares;
    }
  }
  fmt::print("{:<16} {:<10} {:>7} {:>9} {:>7} {:>12} {:>8} {:>7}\n", "controller", "family", "trials", "ms/trial",
             "ODE %", "controller %", "worlds %", "rest %");
  for (const auto& [name, s] : table) {
    const auto percent = [&s = s](double seconds) { return 100.0 * seconds / s.total; };
    fmt::print("{} {:>7} {:>9.1f} {:>7.1f} {:>12.1f} {:>8.2f} {:>7.1f}\n", name, s.trials, 1e3 * s.total / s.trials,
               percent(s.ode), percent(s.controller), percent(s.worlds),
               percent(s.total - s.ode - s.controller - s.worlds));
  }
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "TRIALS", moma::run); }
