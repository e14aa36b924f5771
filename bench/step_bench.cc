// One control step of Frankie, whole and in parts:
//   build/moma_bench_step --benchmark_repetitions=9 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <memory>
#include <random>

#include "controller/config/controller_file.h"
#include "controller/config/robot_file.h"
#include "controller/controller.h"
#include "controller/controller_core.h"
#include "controller/model/manipulability.h"
#include "controller/qp/pose.h"
#include "controller/situation.h"

namespace moma {
namespace {

std::string path(const std::string& file) { return std::string(MOMA_SOURCE_DIR) + "/configs/" + file; }

std::shared_ptr<const RobotModel> frankie() {
  static const std::shared_ptr<const RobotModel> model = config::load_robot(path("robots/frankie.yaml")).model;
  return model;
}

ControllerParams preset(const std::string& name) {
  std::vector<std::string> warnings;
  return config::read_controller(config::load_yaml(path("controllers/" + name + ".yaml")), "", *frankie(), 0.02,
                                 warnings);
}

// The states of one run to a goal 2.5 m away through a lane of spheres, boxes and capsules, close enough on both
// sides that rows come and go all the way.
struct Drive {
  std::vector<ObjectShape> shapes;
  std::vector<Observation> states;

  Drive(const ControllerParams& params, int objects) {
    std::mt19937_64 rng(7);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(rng);
    };
    const auto model = frankie();
    Observation o;
    o.q = model->ready;
    o.qdot = VectorX::Zero(model->num_velocities());
    const Kinematics kin(model);
    o.goal.X_WG = kin.X_WE();
    o.goal.X_WG.translation() += Vector3(2.5, 0.4, -0.1);
    o.goal.X_WG.linear() = Eigen::AngleAxisd(0.6, Vector3::UnitZ()) * o.goal.X_WG.linear();
    for (int i = 0; i < objects; ++i) {
      ObjectShape shape{std::string("o") + std::to_string(i), {}};
      switch (i % 3) {
        case 0:
          shape.shape = {ShapeKind::kSphere, {uniform(0.05, 0.2), 0, 0}, nullptr};
          break;
        case 1:
          shape.shape = {ShapeKind::kBox, {uniform(0.1, 0.4), uniform(0.1, 0.4), uniform(0.1, 1.2)}, nullptr};
          break;
        default:
          shape.shape = {ShapeKind::kCapsule, {uniform(0.04, 0.12), uniform(0.2, 1.0), 0}, nullptr};
      }
      ObjectState state;
      state.X_WO.translation() = Vector3(uniform(0.6, 3.4), (i % 2 ? 1 : -1) * uniform(0.5, 0.8), uniform(0.3, 1.1));
      state.X_WO.linear() = Eigen::AngleAxisd(uniform(-3, 3), Vector3::UnitZ()).toRotationMatrix();
      shapes.push_back(shape);
      o.objects.push_back(state);
    }
    Controller controller(model, params, 0.02);
    controller.reset(shapes);
    StepResult r;
    controller.prepare(r);
    for (int i = 0; i < 400; ++i) {
      states.push_back(o);
      controller.step(o, r);
      integrate(*model, o.base, o.q, r.command, 0.02);
      o.qdot = r.command;
    }
  }
};

void report(benchmark::State& state, double rows, double iterations, double failed) {
  const auto n = static_cast<double>(state.iterations());
  state.counters["rows"] = rows / n;
  state.counters["iterations"] = iterations / n;
  state.counters["fallback"] = failed / n;
}

void step(benchmark::State& state, const std::string& name) {
  const ControllerParams params = preset(name);
  const Drive drive(params, static_cast<int>(state.range(0)));
  Controller controller(frankie(), params, 0.02);
  controller.reset(drive.shapes);
  StepResult r;
  controller.prepare(r);
  std::size_t i = 0;
  double rows = 0, iterations = 0, failed = 0;
  for (auto _ : state) {
    controller.step(drive.states[i], r);
    benchmark::DoNotOptimize(r.command.data());
    i = i + 1 < drive.states.size() ? i + 1 : 0;
    rows += r.rows;
    iterations += r.iterations;
    failed += r.fallback != Fallback::kNone;
  }
  report(state, rows, iterations, failed);
}
void Step(benchmark::State& state) { step(state, "holistic"); }
void StepReactive(benchmark::State& state) { step(state, "moma-reactive"); }
void StepSafe(benchmark::State& state) { step(state, "moma-safe"); }
void StepMoma(benchmark::State& state) { step(state, "moma"); }
BENCHMARK(Step)->Arg(0)->Arg(10)->Arg(40)->ArgName("objects");
BENCHMARK(StepReactive)->Arg(0)->Arg(10)->Arg(40)->ArgName("objects");
BENCHMARK(StepSafe)->Arg(0)->Arg(10)->Arg(40)->ArgName("objects");
BENCHMARK(StepMoma)->Arg(0)->Arg(10)->Arg(40)->ArgName("objects");

void PartKinematics(benchmark::State& state) {
  const Drive drive(preset("holistic"), 0);
  Kinematics kin(frankie());
  std::size_t i = 0;
  for (auto _ : state) {
    kin.update(drive.states[i].base, drive.states[i].q);
    benchmark::DoNotOptimize(kin.J_WE_W().data());
    i = i + 1 < drive.states.size() ? i + 1 : 0;
  }
}
BENCHMARK(PartKinematics);

void PartManipulability(benchmark::State& state) {
  Kinematics kin(frankie());
  const Matrix6X J = kin.J_WE_W().rightCols(7);
  const Eigen::VectorXi prismatic = Eigen::VectorXi::Zero(7);
  VectorX gradient(7);
  for (auto _ : state) {
    benchmark::DoNotOptimize(manipulability_gradient(J, prismatic, ManipulabilityRows::kTranslation, gradient).value);
  }
}
BENCHMARK(PartManipulability);

void PartDistances(benchmark::State& state) {
  const ControllerParams params = preset("holistic");
  const Drive drive(params, static_cast<int>(state.range(0)));
  std::vector<Kinematics> kin;
  for (const Observation& o : drive.states) {
    kin.emplace_back(frankie());
    kin.back().update(o.base, o.q);
  }
  Proximity proximity(frankie());
  proximity.set_objects(drive.shapes);
  std::size_t i = 0;
  double pairs = 0;
  for (auto _ : state) {
    pairs += static_cast<double>(proximity.query(kin[i], drive.states[i].objects, {.object = 0.3}).size());
    i = i + 1 < drive.states.size() ? i + 1 : 0;
  }
  state.counters["pairs"] = pairs / static_cast<double>(state.iterations());
}
BENCHMARK(PartDistances)->Arg(10)->Arg(40)->ArgName("objects");

// Terms, tracking, bounds, wheels and collision rows; distances known.
void PartRows(benchmark::State& state) {
  const auto model = frankie();
  const ControllerParams params = resolved(preset("holistic"), *model);
  const Drive drive(params, static_cast<int>(state.range(0)));
  struct Look {
    explicit Look(const ControllerParams& p) : assessment(frankie(), p), poser(frankie(), p, 0.02) {}
    Assessment assessment;
    QpPoser poser;
  };
  std::vector<std::unique_ptr<Look>> looks;
  std::vector<Situation> situations;
  constexpr std::size_t kEvery = 8;
  for (std::size_t i = 0; i < drive.states.size(); i += kEvery) {
    looks.push_back(std::make_unique<Look>(params));
    looks.back()->poser.set_objects(drive.shapes);
    situations.push_back(looks.back()->assessment.assess(drive.states[i], {}, {}, nullptr));
    looks.back()->poser.look(situations.back());
  }
  std::size_t i = 0;
  double count = 0;
  for (auto _ : state) {
    const Posed posed = looks[i]->poser.pose({.task = situations[i].servo}, situations[i]);
    count += posed.problem.rows;
    benchmark::DoNotOptimize(posed.problem.A.data());
    i = i + 1 < looks.size() ? i + 1 : 0;
  }
  state.counters["rows"] = count / static_cast<double>(state.iterations());
}
BENCHMARK(PartRows)->Arg(0)->Arg(10)->Arg(40)->ArgName("objects");

void PartSolve(benchmark::State& state) {
  const ControllerParams params = preset("holistic");
  const Drive drive(params, static_cast<int>(state.range(0)));
  ControllerCore controller(frankie(), params, 0.02);
  controller.reset(drive.shapes);
  StepResult r;
  controller.prepare(r);
  std::vector<QpProblem> problems;
  for (const Observation& o : drive.states) {
    controller.step(o, r);
    if (r.status == StepStatus::kSolved) problems.push_back(controller.problem());
  }
  const auto solver = make_solver();
  solver->allocate(problems[0].n(), problems[0].capacity());
  QpSolution solution;
  solution.allocate(problems[0].n(), problems[0].capacity());
  std::size_t i = 0;
  double iterations = 0, failed = 0;
  for (auto _ : state) {
    failed += solver->solve(problems[i], solution) != StepStatus::kSolved;
    iterations += solution.iterations;
    i = i + 1 < problems.size() ? i + 1 : 0;
  }
  state.counters["iterations"] = iterations / static_cast<double>(state.iterations());
  state.counters["failed"] = failed / static_cast<double>(state.iterations());
}
BENCHMARK(PartSolve)->Arg(0)->Arg(10)->Arg(40)->ArgName("objects");

}  // namespace
}  // namespace moma

BENCHMARK_MAIN();
