// Every number of the page is the store's: the data block against SQL.
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "reports/render/report.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

using nlohmann::json;

json cell_of(const SQLite::Column& cell) {
  if (cell.isNull()) return nullptr;
  if (cell.isInteger()) return cell.getInt64();
  if (cell.isFloat()) return cell.getDouble();
  return cell.getString();
}

json page_of_kind(const Folder& folder, const std::string& kind, int worlds) {
  make_store(folder / "a.db", kind, worlds);
  return page_of({folder / "a.db"});
}

class PageEqualsStore : public testing::TestWithParam<const char*> {};

TEST_P(PageEqualsStore, EveryCellOfTrials) {
  const Folder folder;
  const json page = page_of_kind(folder, GetParam(), 10);
  const json& columns = page.at("trials").at("columns");
  SQLite::Database store((folder / "a.db").string());
  std::map<std::string, std::size_t> place;
  const std::size_t n = page.at("trials").at("n").get<std::size_t>();
  for (std::size_t i = 0; i < n; ++i) {
    place[page_cell(columns.at("trial"), i).get<std::string>() + "|" +
          page_cell(columns.at("controller"), i).get<std::string>() + "|" +
          page_cell(columns.at("point"), i).get<std::string>()] = i;
  }
  SQLite::Statement query(store, "SELECT * FROM v_trials");
  std::size_t rows = 0;
  std::size_t numbers = 0;
  for (; query.executeStep(); ++rows) {
    const std::string key = query.getColumn("trial").getString() + "|" + query.getColumn("controller").getString() +
                            "|" + query.getColumn("point").getString();
    ASSERT_TRUE(place.count(key)) << key << " is not in the page";
    for (int i = 0; i < query.getColumnCount(); ++i) {
      const std::string name = query.getColumnName(i);
      if (name == "params") continue;
      EXPECT_EQ(page_cell(columns.at(name), place[key]), cell_of(query.getColumn(i))) << key << " " << name;
      numbers += query.getColumn(i).isFloat() ? 1 : 0;
    }
  }
  EXPECT_EQ(rows, n);
  EXPECT_EQ(place.size(), n);
  EXPECT_GT(numbers, 30 * n / 2);
  for (const auto& [name, column] : columns.items()) {
    EXPECT_EQ((column.is_array() ? column : column.at("codes")).size(), n) << name;
  }
}

TEST_P(PageEqualsStore, EveryCellOfTheSummary) {
  const Folder folder;
  const json page = page_of_kind(folder, GetParam(), 10);
  SQLite::Database store((folder / "a.db").string());
  SQLite::Statement query(store, "SELECT * FROM v_summary");
  std::size_t rows = 0;
  for (; query.executeStep(); ++rows) {
    json wanted = json::object();
    for (int i = 0; i < query.getColumnCount(); ++i) wanted[query.getColumnName(i)] = cell_of(query.getColumn(i));
    EXPECT_EQ(std::count(page.at("summary").begin(), page.at("summary").end(), wanted), 1) << wanted.dump();
  }
  EXPECT_EQ(rows, page.at("summary").size());
}

INSTANTIATE_TEST_SUITE_P(Stores, PageEqualsStore, testing::Values("demo", "one", "failures", "hostile", "sweep"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST(PageData, TrialsThatEndByAnErrorDidNotSucceed) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 20);
  for (const std::string table : {"trial", "point_trial"}) {
    change(folder / "a.db",
           "UPDATE " + table + " SET outcome = 'success' WHERE outcome = 'error'; UPDATE " + table +
               " SET outcome = 'error' WHERE key IN (SELECT m.key FROM point_trial AS m JOIN point AS p "
               "ON p.id = m.point_id WHERE p.controller = 'moma' OR m.world_index < 4)");
  }
  const json page = page_of({folder / "a.db"});
  for (const json& row : page.at("overall")) {
    const bool never = row.at("controller") == "moma";
    EXPECT_EQ(row.at("n"), 20);
    EXPECT_EQ(row.at("errors"), never ? 20 : 4);
    EXPECT_EQ(row.at("success_rate") == 0.0, never);
    EXPECT_EQ(row.at("success_without_errors").is_null(), never);
  }
  SQLite::Database store((folder / "a.db").string());
  const double rate = store
                          .execAndGet(
                              "SELECT avg(m.outcome = 'success') FROM point_trial AS m JOIN point AS p ON p.id = "
                              "m.point_id WHERE p.controller = 'holistic'")
                          .getDouble();
  EXPECT_EQ(page.at("overall").at(0).at("controller"), "holistic");
  EXPECT_DOUBLE_EQ(page.at("overall").at(0).at("success_rate").get<double>(), rate);
}

TEST(PageData, MetricsOfASuiteStandBesideMomas) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 12);
  change(folder / "a.db",
         "INSERT INTO metric (id, name, file_name, expression) VALUES (1, 'jitter', 'jitter', 'max(t)'), "
         "(2, 'steps', 'steps', 'count(*)'); "
         "INSERT INTO metric_value SELECT 1, key, position_error_m FROM trial; "
         "INSERT INTO metric_value SELECT 2, key, NULL FROM trial");
  const json page = page_of({folder / "a.db"});
  std::vector<std::string> own;
  for (const json& metric : page.at("metrics"))
    if (metric.contains("own")) own.push_back(metric.at("key"));
  EXPECT_EQ(own, (std::vector<std::string>{"jitter", "metric_steps"})) << "moma has a column `steps`";
  const json& columns = page.at("trials").at("columns");
  for (std::size_t i = 0; i < page.at("trials").at("n").get<std::size_t>(); ++i) {
    EXPECT_EQ(page_cell(columns.at("jitter"), i), page_cell(columns.at("position_error_m"), i));
    EXPECT_TRUE(page_cell(columns.at("metric_steps"), i).is_null());
  }
  SQLite::Database store((folder / "a.db").string());
  for (const json& row : page.at("overall")) {
    SQLite::Statement mean(store,
                           "SELECT avg(t.position_error_m) FROM trial AS t JOIN point_trial AS m ON m.key = t.key "
                           "JOIN point AS p ON p.id = m.point_id WHERE p.controller = ? AND m.outcome <> 'error'");
    mean.bind(1, row.at("controller").get<std::string>());
    ASSERT_TRUE(mean.executeStep());
    EXPECT_NEAR(row.at("own").at("jitter").get<double>(), mean.getColumn(0).getDouble(), 1e-12);
  }
}

TEST(PageData, ManyTrialsAreShownByTheirFirstWorlds) {
  const Folder folder;
  const json whole = page_of_kind(folder, "demo", 40);
  EXPECT_EQ(whole.at("trials").at("n"), 80);
  EXPECT_EQ(whole.at("trials").at("stored"), 80);
  ReportOptions options;
  options.trials = 31;  // two points: 15 worlds
  const json part = page_of({folder / "a.db"}, options);
  EXPECT_EQ(part.at("trials").at("n"), 30);
  EXPECT_EQ(part.at("trials").at("stored"), 80);
  EXPECT_EQ(part.at("trials").at("worlds"), 15);
  const auto texts = [](const json& page, const std::string& name) {
    std::vector<std::string> all;
    for (std::size_t i = 0; i < page.at("trials").at("n").get<std::size_t>(); ++i)
      all.push_back(page_cell(page.at("trials").at("columns").at(name), i).get<std::string>());
    return all;
  };
  const json& worlds = part.at("trials").at("columns").at("world");
  const std::vector<std::string> controllers = texts(part, "controller");
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_LT(worlds.at(i).get<int>(), 15);
    EXPECT_EQ(controllers[i], controllers[i < 15 ? 0 : 29]);
  }
  EXPECT_EQ(part.at("summary"), whole.at("summary"));
  EXPECT_EQ(part.at("overall"), whole.at("overall"));
  const std::vector<std::string> names = texts(part, "trial");
  EXPECT_FALSE(part.at("replays").empty());
  for (const json& replay : part.at("replays"))
    EXPECT_EQ(std::count(names.begin(), names.end(), replay.at("trial").get<std::string>()), 1);
}

TEST(PageData, OverallRatesByHand) {
  const Folder folder;
  const json page = page_of_kind(folder, "demo", 40);
  SQLite::Database store((folder / "a.db").string());
  ASSERT_EQ(page.at("overall").size(), 2u);
  for (const json& row : page.at("overall")) {
    SQLite::Statement query(store, "SELECT outcome, time_to_goal_s, manip_mean FROM v_trials WHERE controller = ?");
    query.bind(1, row.at("controller").get<std::string>());
    double n = 0, hits = 0, collisions = 0, manip = 0;
    std::vector<double> times;
    while (query.executeStep()) {
      ++n;
      hits += query.getColumn(0).getString() == "success";
      collisions += query.getColumn(0).getString() == "collision";
      manip += query.getColumn(2).getDouble();
      if (!query.getColumn(1).isNull()) times.push_back(query.getColumn(1).getDouble());
    }
    std::sort(times.begin(), times.end());
    EXPECT_EQ(row.at("n").get<double>(), n);
    EXPECT_TRUE(row.at("family").is_null());
    EXPECT_DOUBLE_EQ(row.at("success_rate").get<double>(), hits / n);
    EXPECT_DOUBLE_EQ(row.at("collision_rate").get<double>(), collisions / n);
    EXPECT_NEAR(row.at("manip_mean").get<double>(), manip / n, 1e-14);
    const std::size_t k = times.size();
    EXPECT_DOUBLE_EQ(row.at("time_to_goal_median_s").get<double>(), 0.5 * (times[(k - 1) / 2] + times[k / 2]));
    // Wilson's bounds are where the score test just rejects: |p - p0| = z sqrt(p0 (1 - p0) / n).
    const double z = 1.959963984540054;
    for (const char* bound : {"success_low", "success_high"}) {
      const double p0 = row.at(bound).get<double>();
      EXPECT_NEAR(std::abs(hits / n - p0), z * std::sqrt(p0 * (1 - p0) / n), 1e-12) << bound;
    }
    EXPECT_LT(row.at("success_low"), row.at("success_rate"));
    EXPECT_GT(row.at("success_high"), row.at("success_rate"));
  }
}

TEST(PageData, RatesAtTheirEnds) {
  const Folder folder;
  const json page = page_of_kind(folder, "failures", 12);
  for (const json& row : page.at("overall")) {
    EXPECT_EQ(row.at("success_rate"), 0.0);
    EXPECT_EQ(row.at("success_low"), 0.0);
    // With no hit Wilson's upper bound is z^2 / (n + z^2).
    EXPECT_NEAR(row.at("success_high").get<double>(), 3.8414588206941245 / (12 + 3.8414588206941245), 1e-15);
    EXPECT_TRUE(row.at("time_to_goal_median_s").is_null());
  }
}

TEST(PageData, EveryCellOfATuning) {
  const Folder folder;
  const json page = page_of_kind(folder, "tuned", 4);
  ASSERT_EQ(page.at("tuning").size(), 1u);
  const json& search = page.at("tuning").at(0);
  SQLite::Database store((folder / "a.db").string());
  const std::vector<std::pair<std::string, std::string>> parts = {
      {"variables", "SELECT * FROM tune_variable ORDER BY variable"},
      {"evaluations", "SELECT * FROM tune_evaluation ORDER BY evaluation"},
      {"sensitivity", "SELECT * FROM tune_sensitivity ORDER BY variable, value"},
      {"comparisons", "SELECT * FROM tune_comparison ORDER BY entry"}};
  for (const auto& [part, sql] : parts) {
    SQLite::Statement query(store, sql);
    std::size_t row = 0;
    for (; query.executeStep(); ++row) {
      const json& shown = search.at(part).at(row);
      for (const auto& [name, cell] : shown.items()) {
        const json stored = cell_of(query.getColumn(name.c_str()));
        EXPECT_EQ(cell, name == "candidate" ? json::parse(stored.get<std::string>()) : stored) << part << " " << name;
      }
      EXPECT_GE(shown.size(), 5u);
    }
    EXPECT_EQ(row, search.at(part).size()) << part;
    EXPECT_GT(row, 0u) << part;
  }
  EXPECT_EQ(search.at("notes").at(0), "base_weight was found near its lower bound");
}

TEST(PageData, DifficultyAndMissesComeWithEachTrial) {
  const Folder folder;
  const json page = page_of_kind(folder, "demo", 16);
  const json& columns = page.at("trials").at("columns");
  SQLite::Database store((folder / "a.db").string());
  SQLite::Statement query(store,
                          "SELECT w.goal_distance_m, w.objects, e.deadline_misses FROM trial t JOIN world w ON w.id = "
                          "t.world_id JOIN execution e ON e.key = t.key WHERE t.trial = ?");
  for (std::size_t i = 0; i < page.at("trials").at("n"); ++i) {
    query.reset();
    query.bind(1, page_cell(columns.at("trial"), i).get<std::string>());
    ASSERT_TRUE(query.executeStep());
    EXPECT_EQ(columns.at("goal_distance_m").at(i), query.getColumn(0).getDouble());
    EXPECT_EQ(columns.at("objects").at(i), query.getColumn(1).getInt());
    EXPECT_EQ(columns.at("deadline_misses").at(i), query.getColumn(2).getInt());
  }
}

}  // namespace
}  // namespace moma::reports
