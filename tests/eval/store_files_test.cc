#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "eval/store/database.h"
#include "eval/store/merge.h"
#include "eval/store/migrations.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "store_fixture.h"
#include "tests/support/small_disk.h"

namespace moma::test {
namespace {

using store::Access;
using store::StoreError;

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Opening must fail with a message that names the file and has `words`; the file stays as it is.
void expect_refused(const fs::path& file, const std::string& words, Access access = Access::kCreate) {
  const bool is_file = fs::is_regular_file(file);
  const std::string before = is_file ? content(file) : "";
  try {
    store::open_database(file, access);
    ADD_FAILURE() << file << " was opened";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreError::Kind::kUnusable);
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(file.string() + ": ", 0), 0u) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
  if (is_file) {
    EXPECT_EQ(content(file), before) << file << " was changed";
  }
}

TEST(StoreFiles, RefusesWhatIsNoStore) {
  const TemporaryFolder folder;
  for (const Access access : {Access::kCreate, Access::kReadWrite, Access::kReadOnly}) {
    expect_refused(folder.path(), "is a folder", access);
    std::ofstream(folder / "text.db") << "this is a text file, longer than a header of sixteen bytes\n";
    expect_refused(folder / "text.db", "not an SQLite database", access);
    std::ofstream(folder / "short.db") << "short";
    expect_refused(folder / "short.db", "not an SQLite database", access);
  }
  expect_refused(folder / "missing.db", "no such file", Access::kReadOnly);
  expect_refused(folder / "missing.db", "no such file", Access::kReadWrite);
  expect_refused(folder / "missing/a.db", "does not exist", Access::kCreate);
  EXPECT_FALSE(fs::exists(folder / "missing"));
}

TEST(StoreFiles, RefusesDamagedFile) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one"}, 3);
  std::fstream stream(folder / "a.db", std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(100);
  stream << std::string(3000, '\x5a');
  stream.close();
  for (const Access access : {Access::kCreate, Access::kReadWrite, Access::kReadOnly}) {
    expect_refused(folder / "a.db", "damaged", access);
  }
}

TEST(StoreFiles, RefusesAnotherProgramsDatabase) {
  const TemporaryFolder folder;
  {
    SQLite::Database db((folder / "other.db").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    db.exec("PRAGMA application_id = 12345; CREATE TABLE t (x)");
    SQLite::Database plain((folder / "plain.db").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    plain.exec("CREATE TABLE trial (x)");
  }
  for (const Access access : {Access::kCreate, Access::kReadWrite, Access::kReadOnly}) {
    expect_refused(folder / "other.db", "another program", access);
    expect_refused(folder / "plain.db", "another program", access);
  }
}

TEST(StoreFiles, RefusesANewerVersion) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one"}, 1);
  {
    SQLite::Database db((folder / "a.db").string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA user_version = 99");
  }
  for (const Access access : {Access::kCreate, Access::kReadWrite, Access::kReadOnly}) {
    expect_refused(folder / "a.db", "newer moma", access);
  }
}

TEST(StoreFiles, AnEmptyFileBecomesAStore) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.db").close();
  expect_refused(folder / "a.db", "not an SQLite database", Access::kReadOnly);
  write_synthetic(folder / "a.db", {"one"}, 1);
  EXPECT_EQ(store::Reader(folder / "a.db").keys().size(), 1u);
}

// What a run leaves behind that is killed in the very moment in which it makes its store.
TEST(StoreFiles, AStoreWhoseMakingWasKilledIsMadeAgain) {
  const TemporaryFolder folder;
  const fs::path making = folder / "making.db";
  const fs::path killed = folder / "killed.db";
  {
    SQLite::Database db(making.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    db.exec("PRAGMA cache_size = 2; BEGIN IMMEDIATE; CREATE TABLE t (x)");
    db.exec(
        "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 200) "
        "INSERT INTO t SELECT randomblob(1000) FROM n");
    for (const char* suffix : {"", "-journal"}) fs::copy_file(making.string() + suffix, killed.string() + suffix);
  }
  ASSERT_GT(fs::file_size(killed), 0u);
  ASSERT_GT(fs::file_size(killed.string() + "-journal"), 0u);
  try {
    store::open_database(killed, Access::kReadOnly);
    ADD_FAILURE() << "was opened";
  } catch (const StoreError& error) {
    EXPECT_NE(std::string(error.what()).find("a store written by 'moma run' is needed"), std::string::npos)
        << error.what();
  }
  const SQLite::Database db = store::open_database(killed, Access::kCreate);
}

TEST(StoreFiles, NamesWithSpecialCharacters) {
  const TemporaryFolder folder;
  for (const std::string name : {"a b?c#d%41.db", "ünï.db", "quote'.db", "-dash.db"}) {
    write_synthetic(folder / name, {"one"}, 1);
    EXPECT_EQ(store::Reader(folder / name).keys().size(), 1u) << name;
    EXPECT_TRUE(fs::exists(folder / name)) << name;
    EXPECT_EQ(store::merge(folder / "merged.db", {folder / name}).added + 0u, name[0] == 'a' ? 1u : 0u) << name;
  }
}

TEST(StoreFiles, AQueryCannotChangeAnything) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 2);
  const std::string hash = store::Reader(file).result_hash();
  for (const std::string sql : {"DELETE FROM trial", "DROP TABLE trial", "UPDATE trial SET steps = 0",
                                "INSERT INTO suite VALUES (9,'a','b',x'')", "ATTACH 'other.db' AS o",
                                "PRAGMA user_version = 7", "PRAGMA query_only = OFF", "PRAGMA writable_schema = ON",
                                "CREATE TABLE t (x)", "SELECT fts3_tokenizer('simple')"}) {
    EXPECT_THROW(store::query(file, sql), store::QueryError) << sql;
  }
  EXPECT_THROW(store::query(file, "VACUUM INTO '" + (folder / "copy.db").string() + "'"), store::QueryError);
  EXPECT_FALSE(fs::exists(folder / "copy.db"));
  EXPECT_EQ(store::Reader(file).result_hash(), hash);
}

TEST(StoreFiles, FaultsInSqlAreNamed) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 2);
  const auto message = [&](const std::string& sql) -> std::string {
    try {
      store::query(file, sql);
    } catch (const store::QueryError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(message("SELECT outcme FROM v_trials").find("no such column: outcme"), std::string::npos);
  EXPECT_NE(message("SELECT outcme FROM v_trials").find("\n         ^"), std::string::npos)
      << message("SELECT outcme FROM v_trials");
  EXPECT_NE(message("SELEKT 1").find("syntax error"), std::string::npos);
  EXPECT_NE(message("").find("empty"), std::string::npos);
  EXPECT_NE(message(" -- nothing").find("empty"), std::string::npos);
  EXPECT_NE(message("SELECT 1; SELECT 2").find("one statement"), std::string::npos);
  EXPECT_NE(message("SELECT ?").find("parameter"), std::string::npos);
  EXPECT_EQ(message("SELECT 1 ; -- the end"), "no error");
}

TEST(StoreFiles, EveryNamedQueryRuns) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one", "two"}, 9);
  for (const store::NamedQuery& named : store::named_queries()) {
    EXPECT_FALSE(store::query(folder / "a.db", std::string(named.sql)).rows.empty()) << named.name;
  }
}

TEST(StoreFiles, ReadsWhileARunWrites) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  store::Writer writer(file);
  writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 10));
  for (std::uint64_t w = 0; w < 10; ++w) {
    writer.add(synthetic_wanted(0, w), synthetic_world(w), synthetic_row(0, w), nullptr);
    writer.flush();
    EXPECT_EQ(store::Reader(file).keys().size(), w + 1);
  }
}

TEST(StoreFiles, ALockedStoreSaysSo) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 1);
  const SQLite::Exception busy("database is locked", SQLITE_BUSY);
  const StoreError error = store::explain(busy, file, StoreError::Kind::kUnusable);
  EXPECT_NE(std::string(error.what()).find("locked by another program"), std::string::npos);
}

TEST(StoreFiles, TwoWritersTakeTurns) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  store::Writer first(file);
  store::Writer second(file);
  first.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 20));
  second.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 20));
  for (std::uint64_t w = 0; w < 20; ++w) {
    store::Writer& writer = w % 2 == 0 ? first : second;
    writer.add(synthetic_wanted(0, w), synthetic_world(w), synthetic_row(0, w), nullptr);
    writer.flush();
  }
  first.finish(store::RunStatus::kFinished);
  second.finish(store::RunStatus::kFinished);
  const store::Reader reader(file);
  EXPECT_EQ(reader.keys().size(), 20u);
  EXPECT_EQ(reader.suite_names().size(), 1u);
}

TEST(StoreFiles, AMigrationIsAllOrNothing) {
  SQLite::Database db(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  // The views can be dropped, and then a table is missing.
  db.exec("CREATE VIEW v_trials AS SELECT 1; CREATE VIEW v_summary AS SELECT 1; CREATE VIEW v_pairs AS SELECT 1");
  db.exec("PRAGMA user_version = 1");
  EXPECT_THROW(store::migrate(db), SQLite::Exception);
  EXPECT_EQ(store::schema_version(db), 1);
  EXPECT_EQ(db.execAndGet("SELECT group_concat(name) FROM sqlite_schema").getString(), "v_trials,v_summary,v_pairs");
}

TEST(StoreFiles, MergeIsTheUnion) {
  const TemporaryFolder folder;
  write_synthetic(folder / "whole.db", {"one", "two"}, 9);
  write_synthetic(folder / "a.db", {"one", "two"}, 6);
  write_synthetic(folder / "b.db", {"two"}, 9, "b");
  {
    const std::vector<store::Wanted> all = synthetic_jobs(2, 9);
    store::Writer writer(folder / "c.db");
    writer.begin(synthetic_suite({"one", "two"}), {}, all);
    for (const store::Wanted& job : all) {
      if (job.world >= 4) writer.add(job, synthetic_world(job.world), synthetic_row(job.point, job.world), nullptr);
    }
    writer.finish(store::RunStatus::kStopped);
  }
  const store::MergeSummary summary = store::merge(folder / "out.db", {folder / "a.db", folder / "c.db"});
  EXPECT_EQ(summary.added, 18u);
  EXPECT_EQ(summary.present, 4u);
  EXPECT_EQ(store::Reader(folder / "out.db").result_hash(), store::Reader(folder / "whole.db").result_hash());
  EXPECT_TRUE(store::Reader(folder / "out.db").integrity_problems().empty());
  const std::string all = "SELECT suite, controller, world, trial, outcome FROM v_trials ORDER BY 1, 2, 3";
  EXPECT_EQ(store::query(folder / "out.db", all).rows, store::query(folder / "whole.db", all).rows);
  // Again, and with another setting under the same name.
  EXPECT_EQ(store::merge(folder / "out.db", {folder / "c.db", folder / "b.db"}).added, 0u);
  EXPECT_EQ(store::Reader(folder / "out.db").suite_names(), (std::vector<std::string>{"synthetic", "synthetic@2"}));
  EXPECT_EQ(store::query(folder / "out.db", "SELECT * FROM invocation").rows.size(), 3u);
}

TEST(StoreFiles, MergeRefusesContradictionsAndLeavesTheOutputAlone) {
  const TemporaryFolder folder;
  write_synthetic(folder / "a.db", {"one"}, 5);
  write_synthetic(folder / "b.db", {"one"}, 5);
  write_synthetic(folder / "c.db", {"one"}, 8);
  {
    SQLite::Database db((folder / "b.db").string(), SQLite::OPEN_READWRITE);
    db.exec("UPDATE trial SET steps = steps + 1 WHERE key = (SELECT min(key) FROM trial)");
  }
  fs::copy_file(folder / "a.db", folder / "out.db");
  try {
    store::merge(folder / "out.db", {folder / "c.db", folder / "b.db"});
    FAIL() << "merged";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreError::Kind::kContradiction);
    EXPECT_NE(std::string(error.what()).find("b.db"), std::string::npos) << error.what();
  }
  EXPECT_EQ(store::Reader(folder / "out.db").keys().size(), 5u);
  EXPECT_FALSE(fs::exists(folder / "out.db.part"));
  // The machine was another: the first result stays.
  {
    SQLite::Database db((folder / "b.db").string(), SQLite::OPEN_READWRITE);
    db.exec("UPDATE invocation SET machine_class = 'another'");
  }
  EXPECT_EQ(store::merge(folder / "out.db", {folder / "c.db", folder / "b.db"}).added, 3u);
  EXPECT_EQ(store::Reader(folder / "out.db").result_hash(), store::Reader(folder / "c.db").result_hash());
  std::ofstream(folder / "text.db") << "no store at all, only a text\n";
  EXPECT_THROW(store::merge(folder / "out.db", {folder / "text.db"}), StoreError);
  EXPECT_THROW(store::merge(folder / "new.db", {folder / "missing.db"}), StoreError);
  EXPECT_FALSE(fs::exists(folder / "new.db"));
  EXPECT_FALSE(fs::exists(folder / "new.db.part"));
}

TEST(StoreFiles, AFullDiskKeepsWhatIsCommitted) {
  const TemporaryFolder folder;
  const SmallDisk disk(folder / "disk", 600);
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small file system needs root: " << std::strerror(errno);
  const fs::path file = folder / "disk/a.db";
  std::size_t committed = 0;
  bool full = false;
  {
    store::Writer writer(file);
    writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 5000));
    try {
      for (std::uint64_t w = 0; w < 5000; ++w) {
        writer.add(synthetic_wanted(0, w), synthetic_world(w), synthetic_row(0, w), nullptr);
      }
    } catch (const StoreError& error) {
      full = true;
      EXPECT_EQ(error.kind(), StoreError::Kind::kInterrupted);
      EXPECT_NE(std::string(error.what()).find("disk is full"), std::string::npos) << error.what();
    }
    committed = writer.committed();
  }
  ASSERT_TRUE(full) << "the disk was never full";
  EXPECT_GT(committed, 0u);
  // Moved to where there is room, the store is whole and goes on.
  for (const std::string suffix : {"", "-wal"}) {
    if (fs::exists(file.string() + suffix)) fs::copy_file(file.string() + suffix, (folder / "b.db").string() + suffix);
  }
  EXPECT_EQ(store::Reader(folder / "b.db").keys().size(), committed);
  EXPECT_TRUE(store::Reader(folder / "b.db").integrity_problems().empty());
  EXPECT_EQ(write_synthetic(folder / "b.db", {"one"}, 800), committed);
}

TEST(StoreFiles, AFullDiskFromTheStartLeavesNothing) {
  const TemporaryFolder folder;
  const SmallDisk disk(folder / "disk", 40);
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small file system needs root: " << std::strerror(errno);
  try {
    write_synthetic(folder / "disk/a.db", {"one"}, 1);
    FAIL() << "written";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreError::Kind::kUnusable) << error.what();
    EXPECT_NE(std::string(error.what()).find("full"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(fs::is_empty(folder / "disk"));
}

TEST(StoreFiles, AReadOnlyFolderCanBeReadAndNotWritten) {
  const TemporaryFolder folder;
  SmallDisk disk(folder / "disk", 4000);
  if (!disk.mounted()) GTEST_SKIP() << "mounting a file system read-only needs root: " << std::strerror(errno);
  write_synthetic(folder / "disk/a.db", {"one"}, 3);
  ASSERT_TRUE(disk.make_read_only()) << std::strerror(errno);
  EXPECT_EQ(store::Reader(folder / "disk/a.db").keys().size(), 3u);
  expect_refused(folder / "disk/a.db", "cannot be written", Access::kCreate);
  expect_refused(folder / "disk/b.db", "cannot write in the folder", Access::kCreate);
}

}  // namespace
}  // namespace moma::test
