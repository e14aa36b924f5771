// Every column of every table of a store, changed: `moma verify` finds it, or it is named here with the reason why not.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "eval/run/evaluate.h"
#include "eval/run/tune.h"
#include "eval/run/verify.h"
#include "eval/store/definition.h"
#include "eval/store/error.h"
#include "eval/tune/tuning.h"
#include "suite_fixture.h"

namespace moma::test {
namespace {

namespace fs = std::filesystem;

/// Columns whose change no check can find, and why. A new column fails the test until it is checked, or stands here.
const std::map<std::string, std::set<std::string>> kUnseen = {
    {"a clock of the machine measured it, and nothing tells what it said; verify says that it is not checked",
     {"execution.t_solve_median_us", "execution.t_solve_p99_us", "execution.t_solve_max_us",
      "execution.t_step_median_us", "execution.t_step_p99_us", "execution.t_step_max_us", "execution.t_trial_us",
      "execution.deadline_misses"}},
    {"when and where a call of moma ran, by its own word alone; verify says that it is not checked",
     {"invocation.started", "invocation.ended", "invocation.arguments", "invocation.moma_version",
      "invocation.git_commit", "invocation.git_dirty", "invocation.build_type", "invocation.compiler",
      "invocation.compiler_flags", "invocation.libraries", "invocation.host", "invocation.os", "invocation.cpu",
      "invocation.cpu_count", "invocation.threads", "invocation.machine_class", "tune_search.started",
      "tune_search.ended"}},
    {"any call may have met a trial first that others then found there", {"execution.invocation_id"}},
    {"what a call of moma found and did; a merge leaves away what another store had, so that it follows from nothing",
     {"invocation.trials_present", "invocation.trials_done"}},
    {"estimates of a call of moma risk, which the same call on the store makes again; verify says that it is not "
     "checked",
     {"invocation.risk"}},
};

struct Verdict {
  bool sound = false;
  std::string words;
};

Verdict verdict_of(const fs::path& store, double fraction) {
  Verdict verdict;
  run::Listener listener;
  listener.warning = [&](const std::string& text) { verdict.words += text + "\n"; };
  run::VerifyRequest request;
  request.file = store;
  request.fraction = fraction;
  request.threads = 1;
  try {
    const run::Verification found = run::verify(request, listener);
    for (const std::string& text : found.in_doubt) verdict.words += text + "\n";
    verdict.sound = found.findings == 0 && found.in_doubt.empty();
  } catch (const store::StoreError& error) {
    verdict.words += error.what();
  }
  return verdict;
}

struct Cell {
  std::string table, column, rows;
  bool nullable = false;

  std::string name() const { return table + "." + column; }
  /// Values that are there once, so that only a simulation tells.
  double fraction() const { return table == "trial" || table == "samples" || table == "metric_value" ? 1.0 : 0.0; }
};

std::vector<std::string> texts(const SQLite::Database& db, const std::string& sql) {
  std::vector<std::string> all;
  for (SQLite::Statement s(db, sql); s.executeStep();) all.push_back(s.getColumn(0).getString());
  return all;
}

/// Other values for a cell that holds `old` (SQL), the first that the table takes is meant.
std::vector<std::string> others(const SQLite::Database& db, const Cell& cell, const SQLite::Column& old, bool json) {
  const std::string& c = cell.column;
  const std::string text = old.isNull() ? "" : old.getString();
  if (json && text[0] == '{') return {fmt::format("json_set({}, '$.tampered', 1)", c)};
  if (json && text[0] == '[') return {fmt::format("json_insert({}, '$[#]', 1)", c)};
  // Another call: the next number may be no call's, by which of them came first in the order of keys.
  if (c == "invocation_id") return {"(SELECT min(id) FROM invocation WHERE id <> invocation_id)"};
  if (old.isInteger()) return {c + " + 1", "1 - " + c, c + " + 1000"};
  if (old.isFloat()) return {c + " * 1.5 + 0.25"};
  if (old.isBlob()) return {fmt::format("zeroblob(length({}))", c), fmt::format("randomblob(length({}))", c)};
  std::vector<std::string> values = {fmt::format("coalesce({}, '') || 'x'", c)};
  if (old.isNull()) values.insert(values.end(), {"1", "0.5"});
  // One of the words that the column may have.
  const std::string sql = texts(db, fmt::format("SELECT sql FROM sqlite_schema WHERE name = '{}'", cell.table)).at(0);
  const std::size_t at = sql.find(c + " IN (");
  if (at == std::string::npos) return values;
  const std::string list = sql.substr(at + c.size() + 5, sql.find(')', at) - at - c.size() - 5);
  for (std::size_t from = 0; from < list.size(); from = std::min(list.find(", ", from), list.size() - 2) + 2) {
    const std::string word = list.substr(from, list.find(", ", from) - from);
    if (word != "'" + text + "'") values.push_back(word);
  }
  return values;
}

std::vector<std::string> tables() {
  std::vector<std::string> names;
  const std::string sql = store::tables_sql();
  constexpr std::string_view kCreate = "CREATE TABLE ";
  for (std::size_t at = sql.find(kCreate); at != std::string::npos; at = sql.find(kCreate, at + 1))
    names.push_back(sql.substr(at + kCreate.size(), sql.find(' ', at + kCreate.size()) - at - kCreate.size()));
  return names;
}

/// By tables.
class EveryColumn : public ::testing::TestWithParam<std::string> {
 protected:
  /// One store for all tables.
  static void SetUpTestSuite() {
    folder_ = std::make_unique<SuiteFolder>();
    store_ = folder_->root() / "whole.db";
    const fs::path file = folder_->write("suite.yaml", R"(name: small
robot: robots/tiny.yaml
controllers: {plain: controllers/plain.yaml}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 0.2}
success: {dwell: 0.1}
trials: 2
samples: all
metrics: {last: max(t)}
tune:
  variables: {controller.servo.position: {range: [0.2, 4], start: 0.3}, controller.k_epsilon: {range: [0.1, 5]}}
  worlds: 2
  racing: {first: 2, block: 1}
  confirm: {candidates: 1, worlds: 1, neighbours: 0}
  sensitivity: {pairs_of: 2}
  budget: {trials: 8}
  held_out: 2
)");
    run::TuneRequest search;
    search.file = store_;
    search.gains = folder_->root() / "gains.yaml";
    search.threads = 1;
    run::tune(search, tune::load_tuning(file));
    run::EvaluateRequest request;
    request.file = store_;
    request.threads = 1;
    run::evaluate(request, load_suite(file));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  std::vector<Cell> cells() const {
    const SQLite::Database db(store_.string());
    std::vector<std::string> rows = {"true"};
    if (GetParam() == "trial" || GetParam() == "execution")
      rows = {"key IN (SELECT key FROM point_trial)", "key NOT IN (SELECT key FROM point_trial)"};
    std::vector<Cell> cells;
    SQLite::Statement s(db, "SELECT name, \"notnull\" = 0 AND pk = 0 FROM pragma_table_xinfo(?) WHERE hidden = 0");
    s.bind(1, GetParam());
    while (s.executeStep())
      for (const std::string& where : rows)
        cells.push_back({GetParam(), s.getColumn(0).getString(), where, s.getColumn(1).getInt() != 0});
    return cells;
  }

  /// Changes the cell in the first row that has a value; false where it cannot be changed so.
  static bool change(const fs::path& file, const Cell& cell, bool to_null) {
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA foreign_keys = OFF; PRAGMA synchronous = OFF");
    const bool rowid = texts(db, fmt::format("SELECT wr FROM pragma_table_list('{}')", cell.table)).at(0) == "0";
    const std::string key =
        rowid
            ? "rowid"
            : fmt::format("{}", fmt::join(texts(db, fmt::format("SELECT name FROM pragma_table_info('{}') WHERE pk > 0 "
                                                                "ORDER BY pk",
                                                                cell.table)),
                                          ", "));
    const std::string row = fmt::format("({}) = (SELECT {} FROM {} WHERE {} ORDER BY {} IS NULL LIMIT 1)", key, key,
                                        cell.table, cell.rows, cell.column);
    std::vector<std::string> values;
    {
      SQLite::Statement old(
          db, fmt::format("SELECT {0}, json_valid({0}) FROM {1} WHERE {2}", cell.column, cell.table, row));
      if (!old.executeStep()) return false;
      const SQLite::Column value = old.getColumn(0);
      if (to_null && (!cell.nullable || value.isNull())) return false;
      values = to_null ? std::vector<std::string>{"NULL"}
                       : others(db, cell, value, value.isText() && old.getColumn(1).getInt() != 0);
    }
    return std::any_of(values.begin(), values.end(), [&](const std::string& value) {
      try {
        return db.exec(fmt::format("UPDATE {} SET {} = {} WHERE {}", cell.table, cell.column, value, row)) == 1;
      } catch (const SQLite::Exception&) {  // a constraint
        return false;
      }
    });
  }

  inline static std::unique_ptr<SuiteFolder> folder_;
  inline static fs::path store_;
};

TEST_P(EveryColumn, ThatIsChangedIsFound) {
  const Verdict whole = verdict_of(store_, 1.0);
  ASSERT_TRUE(whole.sound) << whole.words;
  std::set<std::string> excused, unseen, changed;
  std::map<std::string, std::string> said;
  for (const auto& [why, columns] : kUnseen)
    for (const std::string& name : columns)
      if (name.starts_with(GetParam() + ".")) excused.insert(name);
  const fs::path copy = folder_->root() / "changed.db";
  for (const Cell& cell : cells()) {
    for (const bool to_null : {false, true}) {
      fs::copy_file(store_, copy, fs::copy_options::overwrite_existing);
      if (!change(copy, cell, to_null)) continue;
      changed.insert(cell.name());
      const Verdict found = verdict_of(copy, cell.fraction());
      if (found.sound) {
        unseen.insert(cell.name());
        EXPECT_TRUE(excused.contains(cell.name())) << cell.name() << (to_null ? " (to NULL)" : "") << " is not found";
      } else {
        said[cell.name()] += fmt::format("where {}: {}\n", cell.rows, found.words);
        EXPECT_NE(found.words.find(cell.table), std::string::npos) << cell.name() << ":\n" << found.words;
      }
    }
    EXPECT_TRUE(changed.contains(cell.name())) << cell.name() << ": the test cannot change it";
  }
  for (const std::string& name : excused)
    EXPECT_TRUE(unseen.contains(name)) << name << " is excused, and found:\n" << said[name];
}

INSTANTIATE_TEST_SUITE_P(Tables, EveryColumn, ::testing::ValuesIn(tables()),
                         [](const auto& table) { return table.param; });

}  // namespace
}  // namespace moma::test
