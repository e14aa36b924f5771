// Cost of simulation and of making worlds. Run as `build/moma_bench_plant`.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "controller/config/robot_file.h"
#include "world/plant/plant.h"
#include "world/scenario/family.h"
#include "world/scenario/worlds.h"

namespace moma {
namespace {

std::shared_ptr<const RobotModel> frankie() {
  static const auto model = config::load_robot(std::string(MOMA_SOURCE_DIR) + "/configs/robots/frankie.yaml").model;
  return model;
}

Worlds worlds(const std::string& families) {
  return Worlds::read(config::parse_yaml("seed: 1\nfamilies: {" + families + "}", "bench"), "worlds");
}

Worlds clutter(std::int64_t objects) { return worlds("clutter: {objects: " + std::to_string(objects) + "}"); }

void wave(VectorX& command, int k) {
  for (Eigen::Index i = 0; i < command.size(); ++i)
    command[i] = 0.1 * std::sin(static_cast<double>(i) + 1.0) * std::sin(0.05 * k);
}

void physics_step(benchmark::State& state) {
  const auto plant = make_plant(frankie(), clutter(state.range(0)).make(frankie(), 3), SimulationConfig{});
  VectorX command = VectorX::Zero(frankie()->num_velocities());
  PlantReport report;
  int k = 0;
  for (auto _ : state) {
    wave(command, ++k / 10);
    plant->advance(command, 0.002, report);
  }
}
BENCHMARK(physics_step)->Arg(0)->Arg(10)->Arg(30)->Unit(benchmark::kMicrosecond);

void kinematic_control_step(benchmark::State& state) {
  const auto plant =
      make_plant(frankie(), clutter(state.range(0)).make(frankie(), 3), SimulationConfig{SimulationMode::kKinematic});
  VectorX command = VectorX::Zero(frankie()->num_velocities());
  PlantReport report;
  int k = 0;
  for (auto _ : state) {
    wave(command, ++k);
    plant->advance(command, 0.02, report);
  }
}
BENCHMARK(kinematic_control_step)->Arg(0)->Arg(10)->Arg(30)->Unit(benchmark::kMicrosecond);

void make_world(benchmark::State& state, const std::string& family) {
  const Worlds source = worlds(family + ": {}");
  std::uint64_t index = 0;
  for (auto _ : state) benchmark::DoNotOptimize(source.make(frankie(), index++));
}

void make_dynamic_plant(benchmark::State& state) {
  const World world = clutter(10).make(frankie(), 3);
  for (auto _ : state) benchmark::DoNotOptimize(make_plant(frankie(), world, SimulationConfig{}));
}
BENCHMARK(make_dynamic_plant)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace moma

int main(int argc, char** argv) {
  for (const moma::FamilyType& type : moma::family_types()) {
    if (type.name == "desk") continue;  // for robots on a table
    benchmark::RegisterBenchmark(("make_world/" + std::string(type.name)).c_str(), moma::make_world,
                                 std::string(type.name))
        ->Unit(benchmark::kMicrosecond);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
