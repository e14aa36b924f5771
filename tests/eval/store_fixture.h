#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "eval/store/writer.h"
#include "tests/support/filled.h"

namespace moma::test {

namespace fs = std::filesystem;

/// A folder of its own, gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "moma-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

/// A suite of made-up points, as if resolved from files.
inline store::SuiteRecord synthetic_suite(const std::vector<std::string>& controllers,
                                          const std::string& setting = "a") {
  store::SuiteRecord suite;
  suite.name = "synthetic";
  suite.setting_hash = store::hash_text(setting);
  suite.resolved =
      fmt::format(R"({{"name":"synthetic","setting":"{}","controllers":{}}})", setting, controllers.size());
  for (const std::string& controller : controllers) {
    store::PointRecord point;
    point.controller = controller;
    point.params = "{}";
    point.robot_name = "arm";
    point.robot_resolved = R"({"name":"arm"})";
    point.controller_resolved = fmt::format(R"({{"name":"{}"}})", controller);
    point.worlds = R"({"seed":1})";
    point.content_hash = store::hash_text(controller + setting);
    point.simulation_version = 1;
    suite.points.push_back(point);
  }
  return suite;
}

inline store::WorldRecord synthetic_world(std::uint64_t index) {
  store::WorldRecord world;
  world.index = index;
  world.seed = "18446744073709551615";
  world.family = index % 2 == 0 ? "open" : "clutter";
  world.goal_distance_m = 1.0 + static_cast<double>(index);
  world.witness_clearance_m = kAbsent;
  world.json = fmt::format(R"({{"index":{}}})", index);
  return world;
}

inline std::string synthetic_key(std::size_t point, std::uint64_t world) {
  return store::to_hex(store::hash_text(fmt::format("{} {}", point, world)));
}

inline store::Wanted synthetic_wanted(std::size_t point, std::uint64_t world) {
  return {point, world, synthetic_key(point, world)};
}

/// A row with every column set to something of its own, but what goes with an outcome, and without a clearance.
inline TrialRow synthetic_row(std::size_t point, std::uint64_t world) {
  TrialRow row;
  const double x = static_cast<double>(world) + 100.0 * static_cast<double>(point);
  Filler(x).fill(row);
  row.outcome = (world + point) % 3 == 0 ? Outcome::kCollision : Outcome::kSuccess;
  row.reason = fmt::format("because of {}", world);
  const bool collision = row.outcome == Outcome::kCollision;
  row.link = collision ? "hand" : "";
  row.object = collision ? "floor" : "";
  row.collision_time_s = collision ? x / 3 : kAbsent;
  row.time_to_goal_s = collision ? kAbsent : 1.0 + x / 7;
  row.collision_depth_m = row.clearance_min_m = row.detector_deepest_m = kAbsent;
  return row;
}

inline std::vector<store::Wanted> synthetic_jobs(std::size_t points, std::uint64_t worlds) {
  std::vector<store::Wanted> jobs;
  for (std::uint64_t w = 0; w < worlds; ++w) {
    for (std::size_t p = 0; p < points; ++p) jobs.push_back(synthetic_wanted(p, w));
  }
  return jobs;
}

/// Writes the whole synthetic suite; trials already there are skipped. Returns how many were.
inline std::size_t write_synthetic(const fs::path& file, const std::vector<std::string>& controllers,
                                   std::uint64_t worlds, const std::string& setting = "a") {
  const std::vector<store::Wanted> jobs = synthetic_jobs(controllers.size(), worlds);
  store::Writer writer(file);
  const auto present = writer.begin(synthetic_suite(controllers, setting), {{"moma", "run"}, 2}, jobs);
  for (const store::Wanted& job : jobs) {
    if (present.count(job.key) > 0) continue;
    writer.add(job, synthetic_world(job.world), synthetic_row(job.point, job.world), nullptr);
  }
  writer.finish(store::RunStatus::kFinished);
  return present.size();
}

/// What defined the stores of an older version (store_tools_test.cc).
std::string schema_of_version(int version);

}  // namespace moma::test
