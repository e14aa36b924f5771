// What works on whole stores: samples(), pairs, metrics of suites, migration, the lock of runs.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/file.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <new>
#include <regex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "eval/store/columns.h"
#include "eval/store/contents.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/merge.h"
#include "eval/store/migrations.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "eval/store/run_lock.h"
#include "eval/store/user_metrics.h"
#include "store_fixture.h"

namespace moma::test {
namespace {

using store::QueryResult;
using store::StoreError;
using store::Writer;

Trace made_up_trace(int n, int joints) {
  Trace trace;
  for (int k = 0; k < n; ++k) {
    Sample s;
    s.t = 0.02 * k;
    s.base = Vector3(0.1 * k, -0.2, 0.0);
    s.q = VectorX::Constant(joints, k);
    s.qdot = VectorX::Constant(joints + 2, 1.0 / 3.0);
    s.command = VectorX::Constant(joints + 2, -k);
    s.error = Vector6::Constant(k);
    s.manipulability = 0.1;
    s.least_distance = k % 2 == 0 ? std::numeric_limits<double>::infinity() : 0.3 + k;
    trace.push_back(s);
  }
  return trace;
}

void write_with_samples(const fs::path& file, std::uint64_t worlds) {
  Writer writer(file);
  writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, worlds));
  for (std::uint64_t w = 0; w < worlds; ++w) {
    const Trace trace = made_up_trace(10 + static_cast<int>(w), 3);
    writer.add(synthetic_wanted(0, w), synthetic_world(w), synthetic_row(0, w), w % 2 == 0 ? &trace : nullptr);
  }
  writer.finish(store::RunStatus::kFinished);
}

std::string complaint(const fs::path& file, const std::string& sql) {
  try {
    store::query(file, sql);
  } catch (const store::QueryError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SamplesFunction, GivesEveryColumnOfEveryStep) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_with_samples(file, 4);
  const std::string trial = synthetic_key(0, 2).substr(0, 9);
  const QueryResult all = store::query(file, "SELECT * FROM samples('" + trial + "')");
  const Trace trace = made_up_trace(12, 3);
  const std::vector<std::string> names = store::sample_columns(3, 5);
  ASSERT_EQ(all.rows.size(), trace.size());
  ASSERT_EQ(all.columns.size(), names.size() + 1);
  EXPECT_EQ(all.columns[0], "step");
  for (std::size_t k = 0; k < trace.size(); ++k) {
    const std::vector<double> row = store::sample_row(trace[k]);
    EXPECT_EQ(std::get<std::int64_t>(all.rows[k][0]), static_cast<std::int64_t>(k));
    for (std::size_t c = 0; c < names.size(); ++c) {
      EXPECT_EQ(all.columns[c + 1], names[c]);
      if (std::isfinite(row[c])) {
        EXPECT_EQ(std::get<double>(all.rows[k][c + 1]), row[c]) << names[c] << " " << k;
      } else {
        EXPECT_TRUE(std::holds_alternative<std::monostate>(all.rows[k][c + 1])) << names[c] << " " << k;
      }
    }
  }
}

TEST(SamplesFunction, JoinsWithTrialsAndLeavesTheTableReachable) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_with_samples(file, 5);
  const QueryResult joined = store::query(
      file,
      "SELECT v.world, count(x.t), max(x.q0) FROM v_trials AS v LEFT JOIN samples(v.trial) AS x GROUP BY v.world "
      "ORDER BY 1");
  ASSERT_EQ(joined.rows.size(), 5u);
  for (std::size_t w = 0; w < 5; ++w)
    EXPECT_EQ(std::get<std::int64_t>(joined.rows[w][1]), w % 2 == 0 ? static_cast<std::int64_t>(10 + w) : 0) << w;
  EXPECT_EQ(std::get<std::int64_t>(store::query(file, "SELECT count(*) FROM samples").rows[0][0]), 3);
  const std::string both =
      "SELECT (SELECT count(*) FROM main.samples), count(*) FROM SAMPLES ('" + synthetic_key(0, 0) + "')";
  EXPECT_EQ(std::get<std::int64_t>(store::query(file, both).rows[0][0]), 3);
}

TEST(SamplesFunction, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_with_samples(file, 40);
  EXPECT_NE(complaint(file, "SELECT * FROM samples('xyz')").find("hex digits"), std::string::npos);
  EXPECT_NE(complaint(file, "SELECT * FROM samples('')").find("hex digits"), std::string::npos);
  EXPECT_NE(complaint(file, "SELECT * FROM samples('00000000000000')").find("no such trial"), std::string::npos);
  std::string some;
  for (int digit = 0; digit < 16 && some.empty(); ++digit) {
    const std::string name(1, "0123456789abcdef"[digit]);
    if (complaint(file, "SELECT count(*) FROM samples('" + name + "')").find("several") != std::string::npos)
      some = name;
  }
  EXPECT_FALSE(some.empty()) << "forty keys over sixteen digits: one has two";
  EXPECT_NE(complaint(file, "SELECT * FROM samples()").find("samples needs a trial"), std::string::npos);
  EXPECT_EQ(complaint(file, "SELECT * FROM samples(NULL)"), "no error");
  EXPECT_NE(complaint(file, "DELETE FROM samples WHERE 'samples(' = ''"), "no error");
  EXPECT_NE(complaint(file, "CREATE TEMP TABLE x AS SELECT * FROM samples('0')"), "no error");
}

TEST(Store, PairsAreCounted) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one", "two", "three"}, 150);
  write_synthetic(file, {"one", "four"}, 131);     // another point with fewer worlds
  write_synthetic(file, {"one", "two"}, 70, "b");  // another setting
  const auto all = store::named_queries();
  const auto pairs = std::find_if(all.begin(), all.end(), [](const auto& one) { return one.name == "pairs"; });
  ASSERT_NE(pairs, all.end());
  const QueryResult counted = store::query(file, std::string(pairs->sql));
  const QueryResult grouped = store::query(
      file,
      "SELECT suite, family, mode, controller_a, point_a, controller_b, point_b, count(*), "
      "sum(success_a AND success_b), sum(success_a AND NOT success_b), sum(success_b AND NOT success_a), "
      "sum(NOT success_a AND NOT success_b) FROM v_pairs GROUP BY suite, robot, family, mode, controller_a, point_a, "
      "controller_b, point_b ORDER BY suite, family, mode, controller_a, point_a, controller_b, point_b");
  EXPECT_GT(grouped.rows.size(), 8u);
  EXPECT_EQ(counted.rows, grouped.rows);
}

// Pairs of points grow with the square of the points. Trials of a pair must not be joined one by one: 20 points in 120
// worlds are 22,800 pairs of trials, each of which costs some thirty steps.
TEST(Store, PairsAreCountedWithoutJoiningTrials) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  std::vector<std::string> controllers;
  for (int i = 0; i < 20; ++i) controllers.push_back(fmt::format("c{}", i));
  write_synthetic(file, controllers, 120);
  const auto& all = store::named_queries();
  const auto pairs = std::find_if(all.begin(), all.end(), [](const auto& one) { return one.name == "pairs"; });
  ASSERT_NE(pairs, all.end());
  const QueryResult counted = store::query(file, std::string(pairs->sql));
  EXPECT_EQ(counted.rows.size(), 2u * 20 * 19 / 2);
  EXPECT_GT(counted.steps, 20 * 120) << "each trial is read";
  EXPECT_LT(counted.steps, 300'000);
}

// A file of frozen worlds may hold one of them twice.
TEST(Store, PairsOfWorldsThatAreAlikeAreCountedEach) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"a", "b"}, 12);
  const auto& all = store::named_queries();
  const auto pairs = std::find_if(all.begin(), all.end(), [](const auto& one) { return one.name == "pairs"; });
  ASSERT_NE(pairs, all.end());
  const QueryResult before = store::query(file, std::string(pairs->sql));
  {
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
    db.exec("UPDATE point_trial SET world_id = (SELECT min(id) FROM world)");
  }
  EXPECT_EQ(store::query(file, std::string(pairs->sql)).rows, before.rows);
}

TEST(SamplesFunction, KeysOfATamperedStore) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_with_samples(file, 2);
  {
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA ignore_check_constraints = ON; PRAGMA foreign_keys = OFF");
    db.exec("UPDATE trial SET key = x'aabb' WHERE key = (SELECT min(key) FROM trial)");
  }
  EXPECT_NE(complaint(file, "SELECT * FROM samples('aab')").find("the trial's key has 2 bytes instead of 16"),
            std::string::npos);
}

TEST(UserMetrics, AreAggregatesOverTheSamples) {
  const store::UserMetrics metrics({{"steps", "count(*)"},
                                    {"near", "min(iif(least_distance < 5, t, NULL))"},
                                    {"way", "max(base_x) - min(base_x)"},
                                    {"never", "max(iif(t > 1e9, t, NULL))"},
                                    {"text",
                                     "'five'"
                                     " || count(*)"},
                                    {"big", "max(1e308) * 10 * count(*)"}},
                                   3, 5);
  const std::vector<double> values = metrics.evaluate(made_up_trace(12, 3));
  EXPECT_EQ(values[0], 12.0);
  EXPECT_EQ(values[1], 0.02);
  EXPECT_EQ(values[2], 0.1 * 11);
  for (int i = 3; i < 6; ++i) EXPECT_TRUE(std::isnan(values[static_cast<std::size_t>(i)])) << i;
  EXPECT_EQ(metrics.evaluate(made_up_trace(4, 3))[0], 4.0) << "nothing is left of the trial before";
  EXPECT_TRUE(std::isnan(metrics.evaluate({})[0]));
}

// A trial of which only some samples were seen would have a value, a wrong one.
TEST(UserMetrics, MemoryThatRunsOutIsNoValue) {
  const store::UserMetrics metrics({{"steps", "count(*)"}}, 3, 5);
  const Trace trace = made_up_trace(5000, 3);
  for (const sqlite3_int64 left : {0, 1'000, 30'000, 300'000}) {
    sqlite3_hard_heap_limit64(sqlite3_memory_used() + left + 1);
    EXPECT_THROW((void)metrics.evaluate(trace), std::bad_alloc) << left;
    sqlite3_hard_heap_limit64(0);
    EXPECT_EQ(metrics.evaluate(trace)[0], 5000.0) << left;
  }
}

TEST(UserMetrics, BadSqlIsRefusedByName) {
  const auto message = [](const std::string& sql) -> std::string {
    try {
      const store::UserMetrics metrics({{"mine", sql}}, 3, 5);
    } catch (const store::MetricError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(message("max(q7)").find("no such column: q7 (did you mean q0?); columns are step, t, base_x, base_y, "
                                    "base_phi, q0 to q2, qdot0 to qdot4,"),
            std::string::npos)
      << message("max(q7)");
  EXPECT_NE(message("max(q0").find("syntax error"), std::string::npos) << message("max(q0");
  EXPECT_NE(message("q0").find("one per trial by an aggregate"), std::string::npos) << message("q0");
  EXPECT_NE(message("max(?)").find("parameter"), std::string::npos);
  EXPECT_NE(message("1); DROP TABLE samples; --"), "no error");
  EXPECT_NE(message("load_extension('x') + count(*)"), "no error");
  EXPECT_NE(message("max(t), 2"), "no error");
  // What is not decided by the samples alone.
  for (const char* sql :
       {"random() + count(*)", "julianday('now') + count(*)", "max(t) + abs(RANDOM())", "count(*) + unixepoch('now')",
        "count(*) + length(current_timestamp)", "count(*) + last_insert_rowid()", "count(*) + sqlite_version()",
        "hex(randomblob(3)) + max(t)"})
    EXPECT_NE(message(sql).find("is not accepted; accepted are abs, "), std::string::npos) << sql << message(sql);
  EXPECT_EQ(message("sum(sqrt(base_x * base_x)) / count(*) + coalesce(max(round(t)), 0) + total(iif(t > 1, 1, 0))"),
            "no error");
}

TEST(UserMetrics, ASlowExpressionEnds) {
  const std::string endless =
      "(WITH RECURSIVE c(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM c{}) SELECT max(i) FROM c)";
  const store::UserMetrics metrics(
      {{"slow", "count(*) + " + fmt::format(fmt::runtime(endless), " WHERE (SELECT count(*) FROM samples) > 0")}}, 3,
      5);
  EXPECT_TRUE(std::isnan(metrics.evaluate(made_up_trace(4, 3))[0]));
  EXPECT_THROW(store::UserMetrics({{"slow", "count(*) + " + fmt::format(fmt::runtime(endless), "")}}, 3, 5),
               store::MetricError);
}

store::SuiteRecord suite_with_metrics(std::vector<std::pair<std::string, std::string>> metrics) {
  store::SuiteRecord suite = synthetic_suite({"one"});
  suite.metrics = std::move(metrics);
  return suite;
}

TEST(UserMetrics, ATrialWithoutItsValueIsComputedAgain) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  const auto run = [&](const store::SuiteRecord& suite, double value) {
    Writer writer(file);
    const auto present = writer.begin(suite, {}, synthetic_jobs(1, 3));
    for (const store::Wanted& job : synthetic_jobs(1, 3)) {
      if (present.count(job.key) > 0) continue;
      const std::vector<double> values(suite.metrics.size(), value);
      writer.add(job, synthetic_world(job.world), synthetic_row(0, job.world), nullptr, values);
    }
    writer.finish(store::RunStatus::kFinished);
    return present.size();
  };
  EXPECT_EQ(run(suite_with_metrics({}), 0), 0u);
  const std::string bare = store::Reader(file).result_hash();
  EXPECT_EQ(run(suite_with_metrics({{"m", "count(*)"}}), 5), 0u) << "no trial has the value";
  EXPECT_EQ(run(suite_with_metrics({{"m", "count(*)"}}), 5), 3u);
  EXPECT_NE(store::Reader(file).result_hash(), bare);
  EXPECT_EQ(run(suite_with_metrics({{"m", "max(t)"}}), kAbsent), 0u) << "another expression of the same name";
  EXPECT_EQ(run(suite_with_metrics({}), 0), 3u);
  const QueryResult values =
      store::query(file, "SELECT metric, count(*), count(value), avg(value) FROM v_metrics GROUP BY metric ORDER BY 1");
  ASSERT_EQ(values.rows.size(), 2u);
  EXPECT_EQ(std::get<std::string>(values.rows[0][0]), "m");
  EXPECT_EQ(std::get<double>(values.rows[0][3]), 5.0);
  EXPECT_EQ(std::get<std::string>(values.rows[1][0]), "m@2");
  EXPECT_EQ(std::get<std::int64_t>(values.rows[1][2]), 0);
  // All of it comes along when stores are joined.
  store::merge(folder / "b.db", {file});
  EXPECT_EQ(store::Reader(folder / "b.db").result_hash(), store::Reader(file).result_hash());
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Every object's definition, blanks and quotes apart.
std::set<std::string> definitions(SQLite::Database& db) {
  std::set<std::string> all;
  SQLite::Statement s(db, "SELECT sql FROM sqlite_schema WHERE sql IS NOT NULL");
  while (s.executeStep()) {
    std::string text;
    const std::string sql = s.getColumn(0).getString();
    for (std::size_t i = 0; i < sql.size(); ++i) {
      if (sql.compare(i, 2, "--") == 0) i = std::min(sql.find('\n', i), sql.size() - 1);
      if (std::isspace(static_cast<unsigned char>(sql[i])) == 0 && sql[i] != '"') text += sql[i];
    }
    all.insert(text);
  }
  return all;
}

/// A store as an older version would have written `fresh`: what that version had no columns for is not there.
void write_as_version(int version, const fs::path& fresh, const fs::path& old) {
  SQLite::Database db(old.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  db.exec(schema_of_version(version));
  db.exec(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", store::kApplicationId, version));
  SQLite::Statement attach(db, "ATTACH ? AS fresh");
  attach.bind(1, fresh.string());
  attach.exec();
  for (const char* table : {"robot", "controller", "resolved_suite", "suite", "point", "world", "invocation", "trial",
                            "execution", "samples", "point_trial"}) {
    const std::string names = db.execAndGet(fmt::format("SELECT group_concat(name, ', ') FROM "
                                                        "pragma_table_xinfo('{}', 'main') WHERE hidden = 0",
                                                        table))
                                  .getString();
    db.exec(fmt::format("INSERT INTO main.{0} ({1}) SELECT {1} FROM fresh.{0}", table, names));
  }
}

/// What `moma verify` finds in the file alone.
std::vector<std::string> findings(const fs::path& file) {
  std::vector<std::string> found;
  store::check_contents(file, [&](const std::string& finding) { found.push_back(finding); });
  return found;
}

TEST(Migration, AStoreOfAnOlderVersionBecomesWhatThisProgramWrites) {
  const TemporaryFolder folder;
  const fs::path fresh = folder / "fresh.db";
  write_synthetic(fresh, {"one", "two"}, 40);
  const std::vector<std::string> views = {"v_trials", "v_summary", "v_pairs", "point_trial"};
  const auto all_of = [](const std::string& view) {
    return fmt::format("SELECT * FROM {} ORDER BY 1, 2, 3, 4, 5, 6, 7, 8", view);
  };
  std::map<std::string, decltype(store::query(fresh, "").rows)> unmigrated;
  for (int version = 1; version <= store::kSchemaVersion; ++version) {
    SCOPED_TRACE(fmt::format("from version {}", version));
    const fs::path old = folder / fmt::format("old-{}.db", version);
    write_as_version(version, fresh, old);
    if (version < store::kSchemaVersion) {
      EXPECT_THROW(store::Reader{old}, StoreError) << "reading alone changes nothing";
    } else {
      EXPECT_EQ(store::Reader(old).keys().size(), 80u) << "columns of later metrics may be missing";
      for (const std::string& view : views) unmigrated[view] = store::query(old, all_of(view)).rows;
      EXPECT_THROW(findings(old), StoreError) << "what is missing can have no digest";
    }
    const fs::path merged = folder / fmt::format("merged-{}.db", version);
    EXPECT_EQ(store::merge(merged, {old}).added, 80u);
    { const SQLite::Database migrated = store::open_database(old, store::Access::kReadWrite); }
    // What is new since the oldest version has its default in a store that was migrated.
    const fs::path same = folder / fmt::format("same-{}.db", version);
    fs::copy_file(fresh, same);
    SQLite::Database a(old.string());
    SQLite::Database b(same.string(), SQLite::OPEN_READWRITE);
    for (const store::TrialColumn& column : store::trial_columns()) {
      if (column.about.earlier == Earlier::kNone || (version >= 3 && column.about.earlier == Earlier::kZero)) continue;
      const bool zero =
          column.about.earlier == Earlier::kZero && !std::holds_alternative<double TrialRow::*>(column.member);
      for (const char* table : {"trial", column.about.averaged() ? "point_trial" : "trial"})
        b.exec(fmt::format("UPDATE {} SET {} = {}", table, column.name, zero ? "0" : "NULL"));
    }
    for (const store::TimingColumn& column : store::timing_columns())
      if (column.about.earlier != Earlier::kNone) b.exec(fmt::format("UPDATE execution SET {} = NULL", column.name));
    EXPECT_EQ(store::schema_version(a), store::kSchemaVersion);
    EXPECT_EQ(definitions(a), definitions(b));
    for (const fs::path& file : {old, merged}) {
      EXPECT_EQ(store::Reader(file).result_hash(), store::Reader(same).result_hash()) << file;
      EXPECT_TRUE(store::Reader(file).integrity_problems().empty()) << file;
      EXPECT_EQ(findings(file), findings(same)) << file;
    }
    for (const std::string& view : views) {
      EXPECT_EQ(store::query(old, all_of(view)).rows, store::query(same, all_of(view)).rows) << view;
      if (unmigrated.contains(view)) {
        EXPECT_EQ(store::query(old, all_of(view)).rows, unmigrated[view]) << view << ", read before";
      }
    }
    EXPECT_EQ(write_synthetic(old, {"one", "two"}, 41), 80u) << "a run goes on with it";
  }
}

TEST(Migration, WordsAreAddedAndThoseOfANewerProgramStay) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 3);
  const auto words = [&](const char* from, const char* to) {
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA writable_schema = ON");
    db.exec(fmt::format("UPDATE sqlite_schema SET sql = replace(sql, '{}', '{}') WHERE name = 'trial'", from, to));
  };
  const auto reopened = [&] {
    SQLite::Database db = store::open_database(file, store::Access::kReadWrite);
    return db.execAndGet("SELECT sql FROM sqlite_schema WHERE name = 'trial'").getString();
  };
  const std::string ours = reopened();
  words("''spilled'', ", "");
  EXPECT_EQ(reopened(), ours);
  words("''spilled'', ", "''spilled'', ''levitated'', ");
  EXPECT_NE(reopened().find("levitated"), std::string::npos);
}

// What the documentation tells people to ask.
TEST(StoreDocumentation, ItsQueriesRun) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_with_samples(file, 6);
  const std::string text = text_of(MOMA_SOURCE_DIR "/docs/reference/store.md");
  std::size_t found = 0;
  for (std::size_t at = text.find("```sql\n"); at != std::string::npos; at = text.find("```sql\n", at + 1)) {
    const std::size_t begin = at + 7;
    std::string sql = text.substr(begin, text.find("```", begin) - begin);
    sql = std::regex_replace(sql, std::regex("samples\\('[0-9a-f]+'\\)"),
                             fmt::format("samples('{}')", synthetic_key(0, 0).substr(0, 12)));
    EXPECT_EQ(complaint(file, sql), "no error") << sql;
    ++found;
  }
  EXPECT_EQ(found, 10u);
}

TEST(RunLock, TheSecondWaitsAndIsToldForWhom) {
  const TemporaryFolder folder;
  const fs::path db = folder / "a.db";
  std::string words;
  auto first = std::make_unique<store::RunLock>(db, nullptr, [](const std::string&) { FAIL() << "it is free"; });
  ASSERT_TRUE(first->held());
  std::atomic<bool> entered{false};
  std::thread second([&] {
    const store::RunLock lock(db, nullptr, [&](const std::string& text) { words = text; });
    entered = lock.held();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  EXPECT_FALSE(entered.load());
  first.reset();
  second.join();
  EXPECT_TRUE(entered.load());
  EXPECT_NE(words.find(fmt::format("process {}", getpid())), std::string::npos) << words;
  EXPECT_FALSE(fs::exists(folder / "a.db-lock"));
}

TEST(RunLock, WaitingCanBeBrokenOff) {
  const TemporaryFolder folder;
  std::atomic<bool> stop{false};
  const store::RunLock first(folder / "a.db", &stop, [](const std::string&) {});
  stop = true;
  const store::RunLock second(folder / "a.db", &stop, [](const std::string&) {});
  EXPECT_TRUE(first.held());
  EXPECT_FALSE(second.held());
  std::ofstream(folder / "b.db-lock") << "left by a program that was killed\n";
  const store::RunLock third(folder / "b.db", &stop, [](const std::string&) {});
  EXPECT_TRUE(third.held()) << "what a killed program leaves behind holds nothing";
}

}  // namespace

/// It is schema-4.sql, and in schema-N.diff what version N had otherwise.
std::string schema_of_version(int version) {
  const std::string folder = MOMA_SOURCE_DIR "/tests/data/store/";
  const std::string command =
      version == 4 ? fmt::format("cat '{}schema-4.sql'", folder)
                   : fmt::format("patch -s -o - '{0}schema-4.sql' '{0}schema-{1}.diff'", folder, version);
  FILE* words = popen(command.c_str(), "r");
  std::string text;
  for (int c = 0; words != nullptr && (c = std::getc(words)) != EOF;) text += static_cast<char>(c);
  if (words == nullptr || pclose(words) != 0) throw std::runtime_error("cannot be run: " + command);
  return text;
}

}  // namespace moma::test
