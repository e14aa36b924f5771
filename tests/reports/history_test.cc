// Stores of one suite over time, and who writes to a store.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <fstream>
#include <string>

#include "reports/render/page_data.h"
#include "reports/render/report.h"
#include "reports/render/store.h"
#include "tests/reports/store_files.h"

namespace moma::reports {
namespace {

using nlohmann::json;

TEST(Invocations, BringTheirEstimatesOfRisk) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 2);
  const auto risk = [&] { return page_of({folder / "a.db"}).at("invocations").at(0).at("risk"); };
  EXPECT_EQ(risk(), json(nullptr));
  change(folder / "a.db", R"(UPDATE invocation SET risk = '[{"controller": "moma", "p": 5.3e-5}]')");
  EXPECT_EQ(risk(), json::parse(R"([{"controller": "moma", "p": 5.3e-5}])"));
  // A store of an earlier build.
  change(folder / "a.db", "ALTER TABLE invocation DROP COLUMN risk");
  EXPECT_EQ(risk(), json(nullptr));
}

TEST(History, StoresOfOneSuiteStandSideBySide) {
  const Folder folder;
  for (const char* name : {"march.db", "june.db"}) make_store(folder / name, "demo", 4);
  change(folder / "june.db",
         "UPDATE invocation SET started = '2025-06-01T08:00:00Z';"
         "UPDATE resolved_suite SET resolved = json_set(resolved, '$.notes', 'since *June*');"
         "UPDATE controller SET resolved = json_set(resolved, '$.lambda_q', 0.02)"
         "  WHERE id = (SELECT controller_id FROM point WHERE controller = 'moma');");
  const json page = page_of({folder / "june.db", folder / "march.db"});
  ASSERT_EQ(page.at("points").size(), 4u);
  const auto lambda = [&](const std::string& controller, const std::string& store) -> double {
    for (const json& point : page.at("points"))
      if (point.at("controller") == controller && point.at("store") == store)
        return point.at("parameters").at("lambda_q");
    return -1.0;
  };
  EXPECT_EQ(lambda("moma (june)", "june"), 0.02);
  EXPECT_EQ(lambda("moma (march)", "march"), 0.01);
  EXPECT_EQ(lambda("holistic (june)", "june"), 0.01);
  // Each run says when it was and which notes its suite had: by these the page orders and heads them.
  ASSERT_EQ(page.at("invocations").size(), 2u);
  for (const json& run : page.at("invocations")) {
    const bool june = run.at("store") == "june";
    EXPECT_EQ(run.at("started"), june ? "2025-06-01T08:00:00Z" : "2025-03-14T09:26:53Z");
    EXPECT_EQ(run.at("notes"), june ? json("since *June*") : json(nullptr));
  }
}

/// Holds the advisory lock of a store as a run does, by a description of its own.
class Holder {
 public:
  Holder(const std::filesystem::path& lock, int how) : file_(open(lock.c_str(), O_RDONLY)) {
    held_ = file_ >= 0 && flock(file_, how | LOCK_NB) == 0;
  }
  ~Holder() { close(file_); }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;
  bool held() const { return held_; }

 private:
  int file_;
  bool held_ = false;
};

TEST(RunState, TheLockTellsWhoWrites) {
  const Folder folder;
  const std::filesystem::path db = folder / "a.db";
  const std::filesystem::path lock = folder / "a.db-lock";
  EXPECT_EQ(writer_of(db), Writer::kUnknown) << "there is no lock";
  std::ofstream(lock) << "";
  EXPECT_EQ(writer_of(db), Writer::kGone) << "nobody holds it";
  {
    const Holder run(lock, LOCK_EX);
    ASSERT_TRUE(run.held());
    EXPECT_EQ(writer_of(db), Writer::kAtWork);
    EXPECT_EQ(writer_of(db), Writer::kAtWork) << "looking changes nothing";
  }
  EXPECT_EQ(writer_of(db), Writer::kGone) << "released";
  const Holder reader(lock, LOCK_SH);
  EXPECT_EQ(writer_of(db), Writer::kGone) << "another one that looks is no run";
  const Holder run(lock, LOCK_EX);
  EXPECT_FALSE(run.held()) << "the reader above holds it, so this test can tell";
}

TEST(RunState, OnlyTheLatestRunMayBeAtWork) {
  const Folder folder;
  make_store(folder / "a.db", "demo", 2);
  change(folder / "a.db",
         "CREATE TEMP TABLE one AS SELECT * FROM invocation; UPDATE one SET id = 2;"
         "INSERT INTO invocation SELECT * FROM one; UPDATE invocation SET status = 'running';");
  const auto writers = [&] {
    const json page = page_of({folder / "a.db"});
    std::string text;
    for (const json& run : page.at("invocations")) text += run.at("writer").get<std::string>() + ";";
    return text;
  };
  EXPECT_EQ(writers(), "unknown;gone;");
  std::ofstream(folder / "a.db-lock") << "";
  EXPECT_EQ(writers(), "gone;gone;");
  const Holder run(folder / "a.db-lock", LOCK_EX);
  ASSERT_TRUE(run.held());
  EXPECT_EQ(writers(), "at work;gone;");
  change(folder / "a.db", "UPDATE invocation SET status = 'finished'");
  EXPECT_FALSE(page_of({folder / "a.db"}).at("invocations").at(0).contains("writer"));
}

}  // namespace
}  // namespace moma::reports
