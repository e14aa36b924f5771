#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "controller/describe/column.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "eval/store/field.h"
#include "eval/store/machine.h"
#include "eval/trial/spec.h"
#include "world/world.h"

namespace moma::store {

// Words that stand in columns of the store. Each column's CHECK is made from them.

/// State of an invocation. A killed program leaves `running` behind, which the next one to write makes `failed`.
enum class RunStatus { kRunning, kFinished, kStopped, kFailed };
constexpr auto words(Of<RunStatus>) {
  return std::to_array<std::string_view>({"running", "finished", "stopped", "failed"});
}

// Rows of the tables without a description of their own elsewhere (eval/trial/row.h, eval/store/samples.h,
// eval/store/search_tables.h). Keys and ids follow from a record's place in its table and are no members.

/// Row of the tables controller and resolved_suite.
struct ContentRow {
  Hash hash{};
  std::string resolved;
};

constexpr void describe(auto& v, Of<ContentRow>) {
  using T = ContentRow;
  v.member("hash", &T::hash, Field{.rule = "UNIQUE"});
  v.member("resolved", &T::resolved, Field{.json = true});
}

struct RobotRow {
  Hash hash{};
  std::string name;
  std::string resolved;
};

constexpr void describe(auto& v, Of<RobotRow>) {
  using T = RobotRow;
  v.member("hash", &T::hash, Field{.text = "XXH3-128 of `resolved`", .rule = "UNIQUE"});
  v.member("name", &T::name, Field{});
  v.member("resolved", &T::resolved, Field{.json = true});
}

struct WorldRecord : Difficulty {
  Hash hash{};  ///< set by the writer
  std::uint64_t index = 0;
  std::string seed;
  std::string family;
  std::string json;
};

constexpr void describe(auto& v, Of<WorldRecord>) {
  using T = WorldRecord;
  v.member("hash", &T::hash, Field{.text = "XXH3-128 of `json`", .rule = "UNIQUE"});
  v.member("world_index", &T::index, Field{});
  v.member("seed", &T::seed, Field{.text = "unsigned 64 bit: more than INTEGER holds"});
  v.member("family", &T::family, Field{});
  describe(v, Of<Difficulty>{});
  v.member("json", &T::json, Field{.json = true});
}

struct MetricRow {
  std::string name;
  std::string file_name;
  std::string expression;
};

constexpr void describe(auto& v, Of<MetricRow>) {
  using T = MetricRow;
  v.member("name", &T::name, Field{.text = "as shown: another expression makes NAME@2 ...", .rule = "UNIQUE"});
  v.member("file_name", &T::file_name, Field{.text = "as in the suite file"});
  v.member("expression", &T::expression, Field{});
}

struct MetricValueRow {
  double value = 0.0;
};

constexpr void describe(auto& v, Of<MetricValueRow>) {
  v.member("value", &MetricValueRow::value, Column{.text = "NULL: the trial has no such value"});
}

struct SuiteRow {
  std::string name;
  std::string file_name;
  Hash setting_hash{};
};

constexpr void describe(auto& v, Of<SuiteRow>) {
  using T = SuiteRow;
  v.member("name", &T::name, Field{.text = "as shown", .rule = "UNIQUE"});
  v.member("file_name", &T::file_name, Field{.text = "as in the suite file"});
  v.member("setting_hash", &T::setting_hash, Field{});
}

struct PointRow {
  std::int64_t suite_id = 0;
  std::string controller;
  std::string controller_name;
  std::string label;
  std::string params;
  Hash content_hash{};
  std::int64_t robot_id = 0;
  std::int64_t controller_id = 0;
  SimulationMode mode{};
  double control_period_s = 0.0, physics_step_s = 0.0, time_limit_s = 0.0;
  double success_position_m = 0.0, success_orientation_rad = 0.0, success_dwell_s = 0.0;
  double stuck_time_s = 0.0, stuck_motion = 0.0;
  double infeasible_time_s = 0.0;
  std::string worlds;
  int simulation_version = 0;
  std::int64_t resolved_suite_id = 0;
  int resolved_position = 0;
};

constexpr void describe(auto& v, Of<PointRow>) {
  using T = PointRow;
  v.member("suite_id", &T::suite_id, Field{.rule = "REFERENCES suite (id)"});
  v.member("controller", &T::controller, Field{.text = "as shown: changed parameters make NAME@2 ..."});
  v.member("controller_name", &T::controller_name, Field{.text = "as in the suite file"});
  v.member("label", &T::label, Field{.text = "'' without a sweep"});
  v.member("params", &T::params, Field{.text = "the swept keys and their values", .json = true});
  v.member("content_hash", &T::content_hash, Field{.text = "of all that decides its trials, but names"});
  v.member("robot_id", &T::robot_id, Field{.rule = "REFERENCES robot (id)"});
  v.member("controller_id", &T::controller_id, Field{.rule = "REFERENCES controller (id)"});
  v.member("mode", &T::mode, Field{});
  v.member("control_period_s", &T::control_period_s, Field{});
  v.member("physics_step_s", &T::physics_step_s, Field{});
  v.member("time_limit_s", &T::time_limit_s, Field{});
  v.member("success_position_m", &T::success_position_m, Field{});
  v.member("success_orientation_rad", &T::success_orientation_rad, Field{});
  v.member("success_dwell_s", &T::success_dwell_s, Field{});
  v.member("stuck_time_s", &T::stuck_time_s, Field{});
  v.member("stuck_motion", &T::stuck_motion, Field{.text = "m or rad"});
  v.member("infeasible_time_s", &T::infeasible_time_s, Field{});
  v.member("worlds", &T::worlds, Field{.text = "the worlds section, resolved", .json = true});
  v.member("simulation_version", &T::simulation_version, Field{});
  v.member("resolved_suite_id", &T::resolved_suite_id,
           Field{.text = "where to build this point from again", .rule = "REFERENCES resolved_suite (id)"});
  v.member("resolved_position", &T::resolved_position, Field{.text = "its place among that suite's points, from 0"});
}

struct InvocationRow : Machine {
  std::int64_t suite_id = 0;
  std::int64_t resolved_suite_id = 0;
  std::string started;
  std::optional<std::string> ended;
  RunStatus status = RunStatus::kRunning;
  std::string arguments;
  std::string moma_version;
  std::optional<std::string> git_commit;
  std::optional<bool> git_dirty;
  std::string build_type, compiler, compiler_flags;
  int threads = 1;
  std::uint64_t trials_planned = 0, trials_present = 0, trials_done = 0;
  std::optional<std::string> risk;
};

constexpr void describe(auto& v, Of<InvocationRow>) {
  using T = InvocationRow;
  v.member("suite_id", &T::suite_id, Field{.rule = "REFERENCES suite (id)"});
  v.member("resolved_suite_id", &T::resolved_suite_id, Field{.rule = "REFERENCES resolved_suite (id)"});
  v.member("started", &T::started, Field{.text = "UTC, ISO 8601"});
  v.member("ended", &T::ended, Field{.text = "NULL: still running, or killed"});
  v.member("status", &T::status, Field{});
  v.member("arguments", &T::arguments, Field{.text = "the command line, a list", .json = true});
  v.member("moma_version", &T::moma_version, Field{});
  v.member("git_commit", &T::git_commit, Field{.text = "NULL: not built from a git checkout"});
  v.member("git_dirty", &T::git_dirty, Field{});
  v.member("build_type", &T::build_type, Field{});
  v.member("compiler", &T::compiler, Field{});
  v.member("compiler_flags", &T::compiler_flags, Field{});
  v.member("libraries", &T::libraries, Field{.text = "name: version", .json = true});
  v.member("host", &T::host, Field{});
  v.member("os", &T::os, Field{});
  v.member("cpu", &T::cpu, Field{});
  v.member("cpu_count", &T::cpu_count, Field{});
  v.member("threads", &T::threads, Field{});
  v.member("machine_class", &T::machine_class, Field{.text = "equal classes must give equal bits"});
  v.member("trials_planned", &T::trials_planned, Field{});
  v.member("trials_present", &T::trials_present, Field{.text = "found already stored"});
  v.member("trials_done", &T::trials_done, Field{});
  v.member("risk", &T::risk, Field{.text = "estimates of moma risk, a list", .json = true});
}

}  // namespace moma::store
