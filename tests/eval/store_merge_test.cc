// Merging: what it has to keep, whom it has to wait for.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>
#include <thread>

#include "eval/store/contents.h"
#include "eval/store/database.h"
#include "eval/store/merge.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "eval/store/run_lock.h"
#include "eval/store/tuning.h"
#include "store_fixture.h"

namespace moma::test {
namespace {

using store::StoreError;

void nobody(const std::string& /*words*/) {}

std::vector<std::vector<store::Cell>> rows(const fs::path& db, const std::string& sql) {
  return store::query(db, sql).rows;
}

/// A search with some evaluations, over or not.
void write_search(const fs::path& file, const std::string& identity, std::uint64_t evaluations, bool finished,
                  bool judged = false, double merit = 1.0) {
  store::Writer writer(file);
  store::SuiteRecord suite = synthetic_suite({"one"});
  writer.begin(suite, {{"moma", "tune"}, 1}, {});
  store::TuneSearchRecord search;
  search.suite = "synthetic";
  search.controller = "one";
  search.identity = fmt::format("\"{}\"", identity);
  search.objective = "in words";
  search.unit = "s";
  search.budget_trials = 100;
  store::TuneRecords records(writer, search, {{"gain", 0, 1, tune::Scale::kLinear, 0.5}});
  for (std::uint64_t i = records.present(); i < evaluations; ++i) {
    tune::Evaluation e;
    e.index = i;
    e.candidate = {0.1 * static_cast<double>(i)};
    e.worlds = 2;
    e.cost = 1.0;
    e.merit = merit;
    e.measured = {1.0, 2.0};
    records.append(e);
  }
  if (finished) {
    tune::SearchResult result;
    result.found = {0.25};
    result.importance = {1.0};
    result.trials = evaluations;
    result.finalists.push_back({{0.25}, 1, 1, 1, 1, 2});
    records.finish(result);
    if (judged) records.verdict(writer.suite_name(), "{}", {}, tune::Verdict::kBetter);
  } else {
    records.stopped();
  }
  writer.finish(store::RunStatus::kFinished);
}

TEST(Merge, BringsSearchesAlongAndGoesOnWithThem) {
  const TemporaryFolder folder;
  write_synthetic(folder / "out.db", {"one"}, 3);
  write_search(folder / "short.db", "a", 3, false);
  write_search(folder / "long.db", "a", 7, true, true);
  write_search(folder / "other.db", "b", 2, true);
  EXPECT_EQ(store::merge(folder / "out.db", {folder / "short.db"}).searches, 1u);
  EXPECT_EQ(rows(folder / "out.db", "SELECT evaluation, candidate, measured FROM tune_evaluation ORDER BY 1"),
            rows(folder / "short.db", "SELECT evaluation, candidate, measured FROM tune_evaluation ORDER BY 1"));
  EXPECT_EQ(store::merge(folder / "out.db", {folder / "long.db", folder / "other.db"}).searches, 2u);
  const std::string searches =
      "SELECT s.identity, s.status, s.verdict, s.held_out_suite, (SELECT count(*) FROM tune_evaluation AS e WHERE "
      "e.search_id = s.id), (SELECT count(*) FROM tune_finalist AS f WHERE f.search_id = s.id), v.found FROM "
      "tune_search "
      "AS s JOIN tune_variable AS v ON v.search_id = s.id ORDER BY 1";
  const auto merged = rows(folder / "out.db", searches);
  ASSERT_EQ(merged.size(), 2u);
  EXPECT_EQ(merged[0], rows(folder / "long.db", searches)[0]);
  EXPECT_EQ(merged[1], rows(folder / "other.db", searches)[0]);
  // What was merged is not taken back by one that is not so far, and twice is once.
  EXPECT_EQ(store::merge(folder / "out.db", {folder / "short.db", folder / "long.db"}).searches, 0u);
  EXPECT_EQ(rows(folder / "out.db", searches), merged);
  EXPECT_TRUE(store::Reader(folder / "out.db").integrity_problems().empty());
  // The other way round comes to the same.
  store::merge(folder / "back.db", {folder / "other.db", folder / "long.db", folder / "short.db"});
  EXPECT_EQ(rows(folder / "back.db", searches), merged);
  write_search(folder / "against.db", "a", 3, false, false, 2.0);
  try {
    store::merge(folder / "out.db", {folder / "against.db"});
    FAIL() << "two paths of one search were merged";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreError::Kind::kContradiction) << error.what();
  }
  EXPECT_EQ(rows(folder / "out.db", searches), merged);
}

void execute(const fs::path& file, const std::string& sql) {
  SQLite::Database(file.string(), SQLite::OPEN_READWRITE).exec(sql);
}

TEST(Merge, KeepsWhatItDoesNotUnderstand) {
  const TemporaryFolder folder;
  write_synthetic(folder / "out.db", {"one"}, 3);
  write_synthetic(folder / "in.db", {"one"}, 5);
  execute(folder / "out.db",
          "CREATE TABLE note (trial TEXT PRIMARY KEY, words TEXT); INSERT INTO note VALUES ('a', 'mine'); "
          "CREATE VIEW noted AS SELECT * FROM note; CREATE TABLE only_out (x); INSERT INTO only_out VALUES (1)");
  execute(
      folder / "in.db",
      "CREATE TABLE note (trial TEXT PRIMARY KEY, words TEXT); INSERT INTO note VALUES ('a', 'mine'), ('b', 'theirs'); "
      "CREATE TABLE \"odd \"\"name\" (\"a b\" INTEGER, c AS (\"a b\" + 1)); INSERT INTO \"odd \"\"name\" VALUES (3); "
      "CREATE INDEX odd_index ON \"odd \"\"name\" (\"a b\"); CREATE VIEW odd_view AS SELECT * FROM \"odd \"\"name\"; "
      "CREATE TRIGGER evil AFTER INSERT ON invocation BEGIN DELETE FROM trial; END; "
      "CREATE VIRTUAL TABLE words USING fts5 (text)");
  const store::MergeSummary summary = store::merge(folder / "out.db", {folder / "in.db"});
  EXPECT_EQ(summary.added, 2u);
  using Cells = std::vector<std::vector<store::Cell>>;
  EXPECT_EQ(rows(folder / "out.db", "SELECT * FROM noted ORDER BY 1"),
            (Cells{{std::string("a"), std::string("mine")}, {std::string("b"), std::string("theirs")}}));
  EXPECT_EQ(rows(folder / "out.db", "SELECT * FROM only_out"), (Cells{{std::int64_t{1}}}));
  EXPECT_EQ(rows(folder / "out.db", "SELECT * FROM odd_view"), (Cells{{std::int64_t{3}, std::int64_t{4}}}));
  EXPECT_EQ(rows(folder / "out.db", "SELECT name FROM sqlite_schema WHERE name IN ('odd_index', 'evil')"),
            (Cells{{std::string("odd_index")}}));
  ASSERT_EQ(summary.notes.size(), 2u) << fmt::format("{}", fmt::join(summary.notes, "\n"));
  EXPECT_NE(summary.notes[0].find("virtual table words"), std::string::npos) << summary.notes[0];
  EXPECT_NE(summary.notes[1].find("trigger evil"), std::string::npos) << summary.notes[1];
  // What would lose something is said, and nothing changes.
  const std::string before = store::Reader(folder / "out.db").result_hash();
  const auto refused = [&](const std::string& sql, const std::string& words) {
    write_synthetic(folder / "x.db", {"one"}, 6);
    execute(folder / "x.db", sql);
    try {
      store::merge(folder / "out.db", {folder / "x.db"});
      ADD_FAILURE() << "merged: " << sql;
    } catch (const StoreError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
    EXPECT_EQ(store::Reader(folder / "out.db").result_hash(), before);
    fs::remove(folder / "x.db");
  };
  refused("CREATE TABLE note (trial TEXT, more)", "table note, which is not moma's, has other columns");
  refused("CREATE TABLE note (trial TEXT PRIMARY KEY, words TEXT); INSERT INTO note VALUES ('a', 'else')",
          "contradicts the one merged before");
  refused("ALTER TABLE world ADD COLUMN mine TEXT", "table world has a column mine that would be lost");
  refused(
      "PRAGMA ignore_check_constraints = ON; INSERT OR REPLACE INTO samples SELECT key, 1, 0, 'no JSON', x'' FROM "
      "trial",
      "x.db: holds or would get what breaks a rule of its tables");
}

TEST(Merge, TriggersOfAStoreNeverRun) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one"}, 3);
  execute(folder / "a.db", "CREATE TRIGGER evil AFTER INSERT ON invocation BEGIN DELETE FROM point_trial; END");
  EXPECT_EQ(write_synthetic(folder / "a.db", {"one"}, 5), 3u);
  EXPECT_EQ(store::Reader(folder / "a.db").keys().size(), 5u);
}

TEST(Merge, WaitsForRunsOnAnyOfItsStores) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one"}, 3);
  write_synthetic(folder / "out.db", {"one"}, 2);
  for (const char* busy : {"out.db", "a.db"}) {
    const std::string before = store::Reader(folder / "out.db").result_hash();
    auto run = std::make_unique<store::RunLock>(folder / busy, nullptr, nobody);
    std::promise<std::string> waits;
    auto merging = std::async(std::launch::async, [&] {
      store::MergeOptions options;
      options.waiting = [&](const std::string& words) { waits.set_value(words); };
      return store::merge(folder / "out.db", {folder / "a.db"}, options);
    });
    EXPECT_NE(waits.get_future().get().find(busy), std::string::npos);
    // Trials of the run that ends meanwhile.
    if (std::string(busy) == "out.db") write_synthetic(folder / "out.db", {"two"}, 4, "b");
    EXPECT_NE(merging.wait_for(std::chrono::milliseconds(0)), std::future_status::ready) << before;
    run.reset();
    merging.get();
    EXPECT_EQ(store::Reader(folder / "out.db").keys().size(), 4u) << busy;
  }
  const store::RunLock run(folder / "a.db", nullptr, nobody);
  const std::atomic<bool> stop{true};
  store::MergeOptions options;
  options.stop = &stop;
  try {
    store::merge(folder / "out.db", {folder / "a.db"}, options);
    FAIL() << "it did not wait";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreError::Kind::kInterrupted) << error.what();
  }
}

TEST(Merge, ManyIntoOneAtOnceLoseNothing) {
  const TemporaryFolder folder;
  constexpr int kStores = 6;
  for (int i = 0; i < kStores; ++i) write_synthetic(folder / fmt::format("{}.db", i), {"one"}, 4, std::to_string(i));
  std::vector<std::thread> threads;
  std::atomic<int> failed{0};
  for (int i = 0; i < kStores; ++i)
    threads.emplace_back([&, i] {
      try {
        store::merge(folder / "out.db", {folder / fmt::format("{}.db", i)});
      } catch (const std::exception& error) {
        ++failed;
        ADD_FAILURE() << error.what();
      }
    });
  for (std::thread& thread : threads) thread.join();
  ASSERT_EQ(failed, 0);
  EXPECT_EQ(store::Reader(folder / "out.db").suite_names().size(), static_cast<std::size_t>(kStores));
  EXPECT_TRUE(store::Reader(folder / "out.db").integrity_problems().empty());
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().extension(), ".db") << entry.path() << " was left behind";
}

TEST(Merge, LeavesWhatAKilledRunLeftBehind) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one"}, 3);
  std::ofstream(folder / "a.db-lock") << "another run (process 1 on x, since 2024)\n";
  store::merge(folder / "out.db", {folder / "a.db"});
  EXPECT_TRUE(fs::exists(folder / "a.db-lock")) << "nobody can tell any more that the run was killed";
  EXPECT_FALSE(fs::exists(folder / "out.db-lock"));
}

}  // namespace
}  // namespace moma::test
