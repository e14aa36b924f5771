// A large store through the real writer: rows per second of CPU time, bytes per trial, and how long queries take.
//
//   moma_bench_store FILE.db [TRIALS] [POINTS]     writes (if FILE is not there), then asks
//
// Rows are made up, but every column is filled as a trial fills it, and the world's JSON is as long as a usual one.
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "eval/store/columns.h"
#include "eval/store/query.h"
#include "eval/store/writer.h"
#include "world/draws.h"

namespace moma {
namespace {

namespace fs = std::filesystem;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

long peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

store::SuiteRecord make_suite(std::size_t points) {
  store::SuiteRecord suite;
  suite.name = "large";
  suite.setting_hash = store::hash_text("large");
  suite.resolved = R"({"name":"large"})";
  for (std::size_t p = 0; p < points; ++p) {
    store::PointRecord point;
    point.controller = fmt::format("controller-{}", p);
    point.params = "{}";
    point.robot_name = "arm";
    point.robot_resolved = R"({"name":"arm"})";
    point.controller_resolved = fmt::format(R"({{"k":{}}})", p);
    point.worlds = R"({"seed":1})";
    point.content_hash = store::hash_text(point.controller);
    point.simulation_version = 1;
    suite.points.push_back(point);
  }
  return suite;
}

store::WorldRecord make_world(std::uint64_t index, const std::string& filler) {
  store::WorldRecord world;
  world.index = index;
  world.seed = "1";
  world.family = index % 2 == 0 ? "open" : "clutter";
  world.goal_distance_m = 1.0 + 0.001 * static_cast<double>(index % 3000);
  world.objects = static_cast<int>(index % 16);
  world.json = fmt::format(R"({{"index":{},"objects":"{}"}})", index, filler);
  return world;
}

TrialRow make_row(std::size_t point, std::uint64_t world) {
  Draws draws(point, world, Stream::kDesign);
  TrialRow row;
  const double u = draws.uniform();
  row.outcome = u < 0.7    ? Outcome::kSuccess
                : u < 0.8  ? Outcome::kCollision
                : u < 0.95 ? Outcome::kStuck
                           : Outcome::kTimeout;
  if (row.outcome == Outcome::kSuccess) row.time_to_goal_s = 2.0 + 6.0 * draws.uniform();
  if (row.outcome == Outcome::kCollision) {
    row.link = "forearm";
    row.object = fmt::format("o{}", world % 16);
    row.collision_count = 1;
    row.collision_time_s = 10.0 * draws.uniform();
    row.collision_depth_m = 0.001 * draws.uniform();
  }
  for (const store::TrialColumn& column : store::trial_columns())
    if (const auto* number = std::get_if<double TrialRow::*>(&column.member))
      if (std::isnan(row.*(*number)) && column.about.null_when.empty()) row.*(*number) = draws.uniform();
  for (double* number : {&row.time_end_s, &row.path_ee_m, &row.path_base_m, &row.clearance_min_m, &row.energy_j})
    *number = draws.uniform();
  row.steps = static_cast<int>(50.0 * row.time_end_s);
  row.timing = {10.0, 20.0, 30.0, 11.0, 22.0, 33.0, 1e4, 0};
  return row;
}

void write(const fs::path& file, std::uint64_t trials, std::size_t points) {
  const std::string filler(1000, 'x');
  const std::uint64_t worlds = trials / points;
  std::vector<store::Wanted> wanted;
  wanted.reserve(worlds * points);
  for (std::uint64_t w = 0; w < worlds; ++w)
    for (std::size_t p = 0; p < points; ++p)
      wanted.push_back({p, w, store::to_hex(store::hash_text(fmt::format("{} {}", p, w)))});
  double rows_cpu = cpu_seconds();
  double filling = 0.0;
  store::Writer writer(file);
  writer.begin(make_suite(points), {{"moma", "run"}, 1}, wanted);
  for (const store::Wanted& job : wanted) {
    const double before = cpu_seconds();
    const TrialRow row = make_row(job.point, job.world);
    const store::WorldRecord world = make_world(job.world, filler);
    filling += cpu_seconds() - before;
    writer.add(job, world, row, nullptr);
  }
  writer.finish(store::RunStatus::kFinished);
  rows_cpu = cpu_seconds() - rows_cpu - filling;
  const auto n = static_cast<double>(wanted.size());
  fmt::print("write   {} trials of {} points: {:.1f} s CPU, {:.0f} trials/s, {:.1f} us a trial\n", wanted.size(),
             points, rows_cpu, n / rows_cpu, 1e6 * rows_cpu / n);
  std::fflush(stdout);
}

void ask(const fs::path& file, const std::string& name, const std::string& sql) {
  timespec a{};
  timespec b{};
  clock_gettime(CLOCK_MONOTONIC, &a);
  const double before = cpu_seconds();
  const store::QueryResult result = store::query(file, sql);
  const double cpu = cpu_seconds() - before;
  clock_gettime(CLOCK_MONOTONIC, &b);
  const double wall = static_cast<double>(b.tv_sec - a.tv_sec) + 1e-9 * static_cast<double>(b.tv_nsec - a.tv_nsec);
  fmt::print("{:<22} {:>8} rows  {:6.2f} s CPU  {:6.2f} s wall  peak {} MiB\n", name, result.rows.size(), cpu, wall,
             peak_mib());
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: moma_bench_store FILE.db [TRIALS] [POINTS]\n");
    return 2;
  }
  const fs::path file = argv[1];
  const std::uint64_t trials = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1000000;
  const std::size_t points = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 10;
  if (points < 1 || trials < points) {
    fmt::print(stderr, "moma_bench_store: needs at least one point, and one trial for each\n");
    return 2;
  }
  if (!fs::exists(file)) write(file, trials, points);
  fmt::print("size    {:.1f} MB, {:.0f} bytes a trial\n", 1e-6 * static_cast<double>(fs::file_size(file)),
             static_cast<double>(fs::file_size(file)) / static_cast<double>(trials));
  for (const store::NamedQuery& query : store::named_queries())
    ask(file, fmt::format("@{}", query.name), std::string(query.sql));
  for (const char* name : {"points", "summary", "overall", "invocations"}) {
    std::ifstream stream(fs::path(MOMA_SOURCE_DIR) / "reports/sql" / fmt::format("{}.sql", name));
    ask(file, fmt::format("report: {}", name), {std::istreambuf_iterator<char>(stream), {}});
  }
  return 0;
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) {
  try {
    return moma::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "moma_bench_store: {}\n", error.what());
    return 1;
  }
}
