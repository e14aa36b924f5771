// Several stores in one report; tables and figures for papers.
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "reports/render/page_data.h"
#include "reports/render/report.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson cell(const OrderedJson& page, const char* column, std::size_t row) {
  return page_cell(page.at("trials").at("columns").at(column), row);
}

/// Two stores of the same worlds; the second's trials are faster, and it is of another suite where asked.
Stores two(const Folder& folder, bool other_suite) {
  make_store(folder / "before.db", "demo", 12);
  make_store(folder / "after.db", "demo", 12);
  change(folder / "after.db", "UPDATE trial SET time_to_goal_s = time_to_goal_s - 1");
  if (other_suite) change(folder / "after.db", "UPDATE suite SET name = 'later', file_name = 'later'");
  return {folder / "before.db", folder / "after.db"};
}

class Compared : public testing::TestWithParam<bool> {};

TEST_P(Compared, StandSideBySideWithEveryNumber) {
  const Folder folder;
  const Stores stores = two(folder, GetParam());
  const OrderedJson page = read_stores(stores, {});
  const std::string suite = GetParam() ? "courier-clutter + later" : "courier-clutter";
  ASSERT_EQ(page.at("stores").size(), 2u);
  EXPECT_EQ(page.at("trials").at("n"), 48);
  std::set<std::string> names;
  for (const OrderedJson& point : page.at("points")) {
    EXPECT_EQ(point.at("suite"), suite);
    names.insert(point.at("controller").get<std::string>());
  }
  EXPECT_EQ(names, (std::set<std::string>{"holistic (before)", "moma (before)", "holistic (after)", "moma (after)"}));
  ASSERT_EQ(page.at("overall").size(), 4u);

  // Each store's numbers, under their new names; the same world has the same name in both.
  std::set<std::string> worlds;
  for (std::size_t s = 0; s < stores.size(); ++s) {
    const OrderedJson alone = read_stores({stores[s]}, {});
    const std::string label = stores[s].stem().string();
    for (std::size_t row = 0; row < 24; ++row) {
      const std::size_t at = 24 * s + row;
      for (const auto& [column, values] : alone.at("trials").at("columns").items()) {
        if (column == "suite" || column == "controller") continue;
        EXPECT_EQ(cell(page, column.c_str(), at), cell(alone, column.c_str(), row)) << label << " " << column;
      }
      EXPECT_EQ(cell(page, "store", at), label);
      EXPECT_EQ(cell(page, "controller", at), cell(alone, "controller", row).get<std::string>() + " (" + label + ")");
      worlds.insert(cell(page, "world_key", at).get<std::string>());
    }
    for (std::size_t i = 0; i < 2; ++i) {
      OrderedJson wanted = alone.at("overall").at(i);
      wanted["controller"] = wanted.at("controller").get<std::string>() + " (" + label + ")";
      wanted["suite"] = suite;
      wanted["store"] = label;
      EXPECT_EQ(page.at("overall").at(2 * s + i), wanted);
    }
  }
  EXPECT_EQ(worlds.size(), 12u);
  for (const OrderedJson& replay : page.at("replays")) {
    EXPECT_TRUE(page.at("robots").contains(replay.at("robot").get<std::string>()));
  }
  EXPECT_GT(page.at("replays").size(), 8u);
}

INSTANTIATE_TEST_SUITE_P(Stores, Compared, testing::Bool(),
                         [](const auto& other) { return other.param ? "OtherSuite" : "SameSuite"; });

TEST(CompareStores, ControllersOfOneStoreKeepTheirNames) {
  const Folder folder;
  two(folder, false);
  change(folder / "after.db",
         "UPDATE point SET controller = controller || '-2', controller_name = controller_name || '-2'");
  std::set<std::string> names;
  const OrderedJson page = read_stores({folder / "before.db", folder / "after.db"}, {});
  for (const OrderedJson& point : page.at("points")) {
    names.insert(point.at("controller").get<std::string>());
  }
  EXPECT_EQ(names, (std::set<std::string>{"holistic", "moma", "holistic-2", "moma-2"}));
}

TEST(CompareStores, AnEmptyOneAndTheSameOneTwice) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 4);
  make_store(folder / "none.db", "empty", 0);
  const OrderedJson page = read_stores({folder / "a.db", folder / "none.db"}, {});
  EXPECT_EQ(page.at("trials").at("n"), 8);
  EXPECT_EQ(page.at("points").at(0).at("controller"), "holistic");
  EXPECT_THROW(read_stores({folder / "a.db", folder / "." / "a.db"}, {}), ReportError);
  EXPECT_THROW(read_stores({}, {}), ReportError);
}

}  // namespace
}  // namespace moma::reports
