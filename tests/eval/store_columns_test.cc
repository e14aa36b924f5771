// Stores from before a metric was there, and what docs/reference/store.md says of the columns.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>

#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/merge.h"
#include "eval/store/migrations.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "eval/store/samples.h"
#include "eval/store/writer.h"
#include "store_fixture.h"
#include "tests/support/filled.h"
#include "tests/support/generated_part.h"

namespace moma::test {
namespace {

using store::StoreError;

constexpr const char* kViews[] = {"v_trials", "v_summary", "v_pairs", "v_metrics", "v_metric_summary"};

/// Makes the store one of a program that did not know these columns yet: without a view that shows them.
void forget(const fs::path& file, const std::vector<std::string>& trial, const std::vector<std::string>& summary) {
  SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
  for (const char* view : kViews) db.exec(fmt::format("DROP VIEW {}", view));
  for (const std::string& name : trial) db.exec(fmt::format("ALTER TABLE trial DROP COLUMN {}", name));
  db.exec("DROP INDEX point_trial_summary");
  for (const std::string& name : summary) db.exec(fmt::format("ALTER TABLE point_trial DROP COLUMN {}", name));
  db.exec(
      "CREATE VIEW v_trials AS SELECT t.trial AS trial, s.name AS suite FROM point_trial AS m "
      "JOIN point AS p ON p.id = m.point_id JOIN suite AS s ON s.id = p.suite_id JOIN trial AS t ON t.key = m.key");
  db.exec("CREATE VIEW v_summary AS SELECT 1 AS n");
  db.exec("CREATE VIEW v_pairs AS SELECT 1 AS n");
  db.exec("CREATE VIEW v_metrics AS SELECT 1 AS n");
}

// The places of metrics in comparisons and summaries leave no doubt about their order.
TEST(StoreColumns, EachShownMetricHasItsPlace) {
  int place = 0;
  for (const store::TrialColumn& column : store::shown_columns()) EXPECT_EQ(column.about.shown.place, ++place);
  EXPECT_GT(place, 0);
  for (const store::TrialColumn& column : store::trial_columns()) {
    const Shown& shown = column.about.shown;
    EXPECT_EQ(shown.place > 0, shown.compared || shown.judged || !shown.summary.empty()) << column.name;
  }
}

TEST(StoreColumns, ANewMetricComesToAStoreByItself) {
  const TemporaryFolder folder;
  const fs::path old = folder / "old.db";
  write_synthetic(old, {"one", "two"}, 4);
  const TrialRow whole = store::Reader(old).trial(synthetic_key(0, 1)).row;
  forget(old, {"slack_max", "steps"}, {"manip_mean"});

  const TrialRow read = store::Reader(old).trial(synthetic_key(0, 1)).row;
  EXPECT_TRUE(std::isnan(read.slack_max)) << "readable as it is";
  EXPECT_EQ(read.steps, 0);
  EXPECT_EQ(read.jerk_ee_rms, whole.jerk_ee_rms);
  EXPECT_EQ(store::Reader(old).keys().size(), 8u);
  EXPECT_FALSE(store::Reader(old).result_hash().empty());

  // A count has to say what it is in rows from before; this one cannot, having been there from the start.
  EXPECT_THROW(store::open_database(old, store::Access::kReadWrite), StoreError);
  {
    SQLite::Database db(old.string(), SQLite::OPEN_READWRITE);
    db.exec("ALTER TABLE trial ADD COLUMN steps INTEGER");
  }
  EXPECT_EQ(write_synthetic(old, {"one", "two"}, 5), 8u) << "a run goes on with it";
  const auto count = [&](const std::string& sql) {
    return std::get<std::int64_t>(store::query(old, sql).rows.at(0).at(0));
  };
  EXPECT_EQ(count("SELECT count(*) FROM v_trials WHERE slack_max IS NULL"), 8);
  EXPECT_EQ(count("SELECT count(*) FROM v_trials WHERE slack_max IS NOT NULL"), 2);
  EXPECT_EQ(count("SELECT count(*) FROM point_trial WHERE manip_mean IS NULL"), 0) << "copied for every trial";
  EXPECT_EQ(count("SELECT count(*) FROM point_trial AS m JOIN trial AS t USING (key) "
                  "WHERE m.manip_mean IS NOT t.manip_mean"),
            0);
  EXPECT_EQ(count("SELECT count(*) FROM sqlite_schema WHERE name = 'point_trial_summary' AND sql LIKE '%manip_mean%'"),
            1);
  EXPECT_EQ(count("SELECT count(*) FROM v_summary WHERE manip_mean IS NULL"), 0);
}

// What counts as a rate is this build's word, also in a store that another one wrote.
TEST(StoreColumns, AStoreIsReadThroughThisBuildsViews) {
  const TemporaryFolder folder;
  const fs::path old = folder / "old.db";
  write_synthetic(old, {"one", "two"}, 4);
  {
    SQLite::Database db(old.string(), SQLite::OPEN_READWRITE);
    db.exec("DROP VIEW v_summary");
    db.exec("CREATE VIEW v_summary AS SELECT 77 AS n");
  }
  const auto count = [&](const std::string& sql) {
    return std::get<std::int64_t>(store::query(old, sql).rows.at(0).at(0));
  };
  EXPECT_EQ(count("SELECT sum(n) FROM v_summary"), 8);
  EXPECT_EQ(count("SELECT n FROM main.v_summary"), 77) << "reading changes nothing";
  write_synthetic(old, {"one", "two"}, 5);
  EXPECT_EQ(count("SELECT sum(n) FROM main.v_summary"), 10) << "a run makes them anew";
}

TEST(StoreColumns, MergeTakesStoresFromBeforeAMetric) {
  const TemporaryFolder folder;
  write_synthetic(folder / "old.db", {"one"}, 4);
  forget(folder / "old.db", {"slack_max"}, {});
  write_synthetic(folder / "new.db", {"one"}, 6);
  // slack_max was there from the start: the same trials with and without it contradict each other.
  EXPECT_THROW(store::merge(folder / "both.db", {folder / "old.db", folder / "new.db"}), StoreError);
  EXPECT_EQ(store::merge(folder / "out.db", {folder / "old.db"}).added, 4u);
  const auto rows = store::query(folder / "out.db", "SELECT count(*), count(slack_max) FROM v_trials").rows;
  EXPECT_EQ(std::get<std::int64_t>(rows[0][0]), 4);
  EXPECT_EQ(std::get<std::int64_t>(rows[0][1]), 0) << "a store without the column joins one that has it";

  {
    SQLite::Database db((folder / "new.db").string(), SQLite::OPEN_READWRITE);
    db.exec("ALTER TABLE trial ADD COLUMN novelty REAL");
  }
  try {
    store::merge(folder / "lost.db", {folder / "new.db"});
    FAIL() << "a metric was lost";
  } catch (const StoreError& error) {
    EXPECT_NE(std::string(error.what()).find("a column novelty that would be lost"), std::string::npos) << error.what();
  }
  EXPECT_EQ(write_synthetic(folder / "new.db", {"one"}, 7), 6u) << "a run leaves the unknown column alone";
  EXPECT_EQ(store::query(folder / "new.db", "SELECT novelty FROM trial").rows.size(), 7u);
}

TEST(StoreColumns, RowsFromBeforeAMetricAgreeWithAnyOfIt) {
  const Column old;
  const Column later{.earlier = Earlier::kUnknown};
  for (const Column& about : {old, later}) {
    EXPECT_TRUE(store::agree(about, 0.5, 0.5));
    EXPECT_FALSE(store::agree(about, 0.5, 0.25));
    EXPECT_FALSE(store::agree(about, 1, 2));
    EXPECT_TRUE(store::agree(about, kAbsent, kAbsent));
  }
  EXPECT_FALSE(store::agree(old, kAbsent, 0.25));
  EXPECT_TRUE(store::agree(later, kAbsent, 0.25));
  EXPECT_FALSE(store::agree(old, 0, 2));
  EXPECT_TRUE(store::agree(later, 0, 2));
}

// A column that was not in the store's version 3 must say that rows from before do not have it.
TEST(StoreColumns, WhatIsNewerThanTheStoreSaysSo) {
  SQLite::Database db(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  db.exec(test::schema_of_version(3));
  const auto check = [&](const std::string& table, const auto& columns) {
    const std::set<std::string> there = store::stored_columns(db, table);
    for (const auto& column : columns)
      EXPECT_EQ(column.about.earlier == Earlier::kUnknown, there.count(std::string(column.name)) == 0)
          << column.name << ": Earlier::kUnknown is for columns that came after version 3, and for all of them";
  };
  check("trial", store::trial_columns());
  check("execution", store::timing_columns());
}

/// As a moma wrote them that did not look ahead yet.
store::EncodedSamples without_plan(const store::EncodedSamples& whole) {
  const store::SampleTable table = store::decode_table(whole);
  std::vector<std::string> names;
  std::vector<double> numbers;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    if (table.names[c].rfind("plan_", 0) == 0) continue;
    names.push_back(table.names[c]);
    numbers.insert(numbers.end(), table.columns[c].begin(), table.columns[c].end());
  }
  store::EncodedSamples old = whole;
  old.columns = nlohmann::json(names).dump();
  const std::size_t bytes = numbers.size() * sizeof(double);
  old.data.resize(ZSTD_compressBound(bytes));
  old.data.resize(ZSTD_compress(old.data.data(), old.data.size(), numbers.data(), bytes, 1));
  return old;
}

TEST(StoreColumns, SamplesFromBeforeAPlanAreRead) {
  Trace trace(4);
  for (std::size_t k = 0; k < trace.size(); ++k) {
    trace[k].q = VectorX::Zero(3);
    trace[k].qdot = trace[k].command = VectorX::Zero(5);
    Filler(static_cast<double>(k)).fill(trace[k]);
  }
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  {
    store::Writer writer(file);
    writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 2));
    for (std::uint64_t w = 0; w < 2; ++w)
      writer.add(synthetic_wanted(0, w), synthetic_world(w), synthetic_row(0, w), &trace);
    writer.finish(store::RunStatus::kFinished);
  }
  const store::EncodedSamples old = without_plan(*store::Reader(file).trial(synthetic_key(0, 0)).samples);
  ASSERT_LT(old.columns.size(), store::encode_samples(trace).columns.size());
  const Trace back = store::decode_samples(old);
  ASSERT_EQ(back.size(), trace.size());
  for (std::size_t k = 0; k < trace.size(); ++k) {
    Sample expected = trace[k];
    expected.plan = PlanBrief{};
    EXPECT_EQ(bits_of(back[k]), bits_of(expected)) << k;
  }

  // One of the two trials is of the old kind, whichever samples() looks at first.
  for (const std::uint64_t w : {0u, 1u}) {
    const fs::path mixed = folder / fmt::format("mixed{}.db", w);
    fs::copy_file(file, mixed);
    {
      SQLite::Database db(mixed.string(), SQLite::OPEN_READWRITE);
      SQLite::Statement change(db, "UPDATE samples SET columns = ?, data = ? WHERE lower(hex(key)) = ?");
      change.bind(1, old.columns);
      change.bind(2, old.data.data(), static_cast<int>(old.data.size()));
      change.bind(3, synthetic_key(0, w));
      ASSERT_EQ(change.exec(), 1);
    }
    const auto asked = [&](std::uint64_t trial) {
      return store::query(mixed, "SELECT count(t), count(plan_mode), max(plan_end_phi) FROM samples('" +
                                     synthetic_key(0, trial) + "')")
          .rows.at(0);
    };
    EXPECT_EQ(std::get<std::int64_t>(asked(w)[0]), 4);
    EXPECT_EQ(std::get<std::int64_t>(asked(w)[1]), 0) << "NULL where there is none";
    EXPECT_EQ(std::get<std::int64_t>(asked(1 - w)[1]), 4);
    EXPECT_EQ(std::get<double>(asked(1 - w)[2]), trace.back().plan.end[2]);
  }
}

std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

template <class Columns>
std::string table_rows(const Columns& columns) {
  std::string rows;
  for (const auto& column : columns) {
    if (!column.about.in_view) continue;
    const std::string null = column.about.null_when.empty() ? "" : fmt::format("; NULL {}", column.about.null_when);
    rows += fmt::format("| `{}` | {} | {}{} |\n", column.name, column.about.unit, cell(column.about.text), null);
  }
  return rows;
}

struct SampleRows {
  std::string rows = "| column | unit | meaning |\n| --- | --- | --- |\n";
  template <class M>
  void member(std::string_view name, M Sample::*, const SampleColumn& about) {
    if constexpr (std::is_same_v<M, EscapeState>) {
      return;
    } else if constexpr (std::is_same_v<M, PlanBrief>) {
      describe(*this, Of<PlanBrief>{});
    } else {
      add<M>(std::string(name), about);
    }
  }
  template <class M>
  void member(std::string_view name, M PlanBrief::*, const About& about) {
    add<M>(fmt::format("plan_{}", name), {.parts = "x y phi", .unit = about.unit, .text = about.text});
  }
  void inlined(PlanVerdict PlanBrief::*) { describe(*this, Of<PlanVerdict>{}); }
  template <class M>
  void member(std::string_view name, M PlanVerdict::*, const About& about) {
    add<M>(fmt::format("plan_{}", name), {.unit = about.unit, .text = about.text});
  }

 private:
  template <class M>
  void add(const std::string& name, const SampleColumn& about) {
    std::string columns = fmt::format("`{}`", name);
    if constexpr (!std::is_arithmetic_v<M> && !std::is_enum_v<M>) {
      columns = fmt::format("`{}0`...", name);
      if (!about.parts.empty()) {
        std::string parts(about.parts);
        columns.clear();
        for (std::size_t at = 0; at < parts.size(); at = std::min(parts.find(' ', at), parts.size()) + 1)
          columns += fmt::format("{}`{}_{}`", columns.empty() ? "" : ", ", name,
                                 parts.substr(at, std::min(parts.find(' ', at), parts.size()) - at));
      }
    }
    std::string text = cell(about.text);
    if constexpr (std::is_enum_v<M>) {
      int k = 0;
      for (const std::string_view word : words(Of<M>{}))
        text += fmt::format("{}{} {}", k == 0 ? ": " : ", ", k, word), ++k;
    }
    rows += fmt::format("| {} | {} | {} |\n", columns, about.unit, text);
  }
};

TEST(StoreDocumentation, ItsTablesAreThoseOfTheProgram) {
  const fs::path page = MOMA_SOURCE_DIR "/docs/reference/store.md";
  expect_generated(page, "columns of v_trials",
                   "| column | unit | meaning |\n| --- | --- | --- |\n" +
                       fmt::format("| `outcome` | | {} |\n", list_of_words<Outcome>(", ", "`")) +
                       table_rows(store::trial_columns()) + table_rows(store::timing_columns()));
  SampleRows samples;
  describe(samples, Of<Sample>{});
  expect_generated(page, "columns of samples", samples.rows);
}

}  // namespace
}  // namespace moma::test
