// The success that is played beside a failure: sql/twin.sql against a search through all trials.
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <set>
#include <string>
#include <vector>

#include "reports/render/report.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

struct Trial {
  std::string name;
  std::string outcome;
  std::int64_t point = 0;
  std::int64_t world = 0;
  bool kept = false;  // its samples
};

std::vector<Trial> all_trials(const std::filesystem::path& db) {
  SQLite::Database store(db.string());
  SQLite::Statement query(store,
                          "SELECT t.trial, t.outcome, m.point_id, t.world_id, x.key IS NOT NULL FROM point_trial AS m "
                          "JOIN trial AS t ON t.key = m.key LEFT JOIN samples AS x ON x.key = t.key");
  std::vector<Trial> all;
  while (query.executeStep())
    all.push_back({query.getColumn(0).getString(), query.getColumn(1).getString(), query.getColumn(2).getInt64(),
                   query.getColumn(3).getInt64(), query.getColumn(4).getInt() != 0});
  return all;
}

/// Successes of other points in the world of a failure: those with samples first, then by point.
const Trial* expected_twin(const std::vector<Trial>& all, const Trial& failed) {
  const Trial* best = nullptr;
  for (const Trial& other : all) {
    if (other.world != failed.world || other.point == failed.point || other.outcome != "success") continue;
    const bool better = best == nullptr || (other.kept != best->kept ? other.kept : other.point < best->point);
    if (better) best = &other;
  }
  return best;
}

class Twins : public testing::TestWithParam<const char*> {};

TEST_P(Twins, AreTheSuccessesOfTheSameWorlds) {
  const Folder folder;
  make_store(folder / "a.db", GetParam(), 16);
  const std::vector<Trial> all = all_trials(folder / "a.db");
  ReportOptions options;
  options.replays = 14;
  options.twins = 9;
  std::vector<std::string> asked;
  options.simulate = [&](const std::filesystem::path&, const std::string& trial) -> std::optional<OwnedSamples> {
    asked.push_back(trial);
    return {};
  };
  const nlohmann::json replays = page_of({folder / "a.db"}, options).at("replays");

  std::set<std::string> shown;
  for (const auto& replay : replays) shown.insert(replay.at("trial").get<std::string>());
  std::size_t wanted = 0;
  // For their rows those with samples, too.
  std::vector<std::string> simulated;
  ASSERT_GE(replays.size(), 14u);
  for (std::size_t i = 0; i < 14; ++i) simulated.push_back(replays.at(i).at("trial"));
  std::set<std::string> there(simulated.begin(), simulated.end());
  for (std::size_t i = 0; i < 9; ++i) {
    const std::string name = replays.at(i).at("trial");
    for (const Trial& trial : all) {
      if (trial.name != name || trial.outcome == "success") continue;
      const Trial* twin = expected_twin(all, trial);
      if (twin == nullptr) continue;
      ++wanted;
      if (there.count(twin->name) == 0) simulated.push_back(twin->name);
      if (!twin->kept) continue;
      there.insert(twin->name);
      EXPECT_EQ(shown.count(twin->name), 1u) << "the success " << twin->name << " beside " << name;
    }
  }
  EXPECT_GE(wanted, 2u) << "the store has failures whose world another point mastered";
  EXPECT_EQ(asked, simulated);

  asked.clear();
  options.twins = 0;
  EXPECT_EQ(page_of({folder / "a.db"}, options).at("replays").size(), 14u);
  EXPECT_EQ(asked.size(), 14u);
}

INSTANTIATE_TEST_SUITE_P(Stores, Twins, testing::Values("demo", "sweep"));

}  // namespace
}  // namespace moma::reports
