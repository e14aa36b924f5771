// Stores as strangers would send them: a small one whose values, tables or bytes were changed as the input says, read
// by all that reads stores. A file of its own in the temporary folder; TMPDIR=/dev/shm makes it quicker.
#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <vector>

#include "eval/store/contents.h"
#include "eval/store/merge.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "eval/store/samples.h"
#include "eval/store/search_tables.h"
#include "tests/eval/store_fixture.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"

namespace moma {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPatience{2000};
constexpr auto kSql = std::to_array<const char*>({"NULL",
                                                  "0",
                                                  "1",
                                                  "-1",
                                                  "7",
                                                  "9223372036854775807",
                                                  "-9223372036854775808",
                                                  "4294967296",
                                                  "1e308",
                                                  "9e999",
                                                  "-9e999",
                                                  "0.5",
                                                  "''",
                                                  "'x'",
                                                  "'success'",
                                                  "x''",
                                                  "x'00'",
                                                  "x'aabb'",
                                                  "x'28b52ffd2000010000'",
                                                  "randomblob(16)",
                                                  "zeroblob(100000)",
                                                  "'[]'",
                                                  "'{}'",
                                                  "'[1]'",
                                                  "'[\"t\"]'",
                                                  "'null'",
                                                  "'{\"a\":'",
                                                  "printf('%.*c', 100000, '[')",
                                                  "char(0)",
                                                  "char(27) || '[2J'",
                                                  "'99999999999999999999'",
                                                  "'</script>'"});

using Columns = std::vector<std::pair<std::string, std::string>>;  ///< tables and their columns

struct Base {
  std::string strict, loose;  ///< the bytes of two stores, the second without rules for values
  Columns columns;
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Base make_base(const fs::path& file) {
  {
    store::Writer writer(file);
    const auto jobs = test::synthetic_jobs(1, 3);
    writer.begin(test::synthetic_suite({"one"}), {{"moma", "run"}, 2}, jobs);
    Trace trace(4);
    test::Filler filler(1.0);
    for (Sample& sample : trace) filler.fill(sample);
    for (const store::Wanted& job : jobs)
      writer.add(job, test::synthetic_world(job.world), test::synthetic_row(0, job.world), &trace);
    writer.finish(store::RunStatus::kFinished);
  }
  Base base;
  SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
  db.exec("PRAGMA journal_mode = DELETE; VACUUM");
  base.strict = bytes_of(file);
  SQLite::Statement columns(db,
                            "SELECT m.name, x.name FROM sqlite_schema AS m, pragma_table_xinfo(m.name) AS x WHERE "
                            "m.type = 'table' AND m.name NOT LIKE 'sqlite%' AND x.hidden = 0");
  while (columns.executeStep())
    base.columns.emplace_back(columns.getColumn(0).getString(), columns.getColumn(1).getString());
  columns.reset();
  db.exec(
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(replace(replace(replace(sql, ') STRICT, "
      "W', ') W'), ') STRICT', ')'), ' NOT NULL', ''), 'CHECK (', 'CHECK (1 OR ') WHERE type = 'table'; PRAGMA "
      "writable_schema = RESET");
  base.loose = bytes_of(file);
  return base;
}

/// Stores whose values are changed: in a transaction of a connection that stays, whose pages are then the file, so that
/// no input pays for reading the schema.
class Changer {
 public:
  explicit Changer(const std::string& bytes) : db_(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
    // Pages of a pager, which has what is not committed; a database that was deserialised would not.
    SQLite::Database image(":memory:", SQLite::OPEN_READWRITE);
    auto* const copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size()));
    std::memcpy(copy, bytes.data(), bytes.size());
    const auto size = static_cast<sqlite3_int64>(bytes.size());
    if (sqlite3_deserialize(image.getHandle(), "main", copy, size, size, SQLITE_DESERIALIZE_FREEONCLOSE) != SQLITE_OK)
      throw std::runtime_error("the store cannot be taken in");
    SQLite::Backup(db_, image).executeStep(-1);
    db_.exec("PRAGMA ignore_check_constraints = ON; PRAGMA foreign_keys = OFF");
  }

  std::string changed(const Columns& columns, fuzz::Bytes& choices) {
    SQLite::Transaction rolled_back(db_);
    for (std::size_t n = 1 + choices.below(4); n > 0; --n) change(columns, choices);
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> pages(
        sqlite3_serialize(db_.getHandle(), "main", &size, 0), &sqlite3_free);
    if (pages == nullptr) throw std::runtime_error("the store cannot be written out");
    return {reinterpret_cast<const char*>(pages.get()), static_cast<std::size_t>(size)};
  }

 private:
  void change(const Columns& columns, fuzz::Bytes& choices) {
    const auto& [table, column] = columns[choices.below(columns.size())];
    const char* value = kSql[choices.below(kSql.size())];
    std::string sql = fmt::format("UPDATE OR IGNORE \"{}\" SET \"{}\" = {}", table, column, value);
    if (choices.below(2) == 1) sql += fmt::format(" WHERE \"{1}\" = (SELECT min(\"{1}\") FROM \"{0}\")", table, column);
    switch (choices.below(16)) {
      case 14:
        sql = fmt::format("DELETE FROM \"{}\"", table);
        break;
      case 15:
        sql = fmt::format("ALTER TABLE \"{}\" DROP COLUMN \"{}\"", table, column);
        break;
      default:
        break;
    }
    try {
      db_.exec(sql);
    } catch (const SQLite::Exception&) {  // a rule of the table
    }
  }

  SQLite::Database db_;
};

void damage(std::string& bytes, fuzz::Bytes& choices) {
  for (std::size_t n = 1 + choices.below(8); n > 0; --n) {
    const std::size_t at = (choices.byte() + std::size_t{256} * choices.byte() + std::size_t{65536} * choices.byte());
    bytes[(choices.below(4) == 0 ? at % 4096 : at) % bytes.size()] = static_cast<char>(choices.byte());
  }
  if (choices.below(10) == 9) bytes.resize(choices.byte() * bytes.size() / 256);
}

/// What may be said of a store that is no good; the program takes anything else for a fault of its own.
template <typename Look>
void look(Look what) {
  try {
    what();
  } catch (const store::StoreError&) {
  } catch (const store::QueryError&) {
  }
}

void unpack(const store::EncodedSamples& samples) {
  try {
    (void)store::decode_samples(samples);
  } catch (const std::runtime_error&) {
  }
}

}  // namespace
}  // namespace moma

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  static const test::TemporaryFolder kFolder;
  static const Base kBase = make_base(kFolder / "base.db");
  static Changer loose(kBase.loose), strict(kBase.strict);
  const fs::path file = kFolder / "a.db";
  fuzz::Bytes choices(data, size);
  for (const char* end : {"", "-journal", "-wal", "-shm"}) fs::remove(file.string() + end);
  const std::size_t kind = choices.below(8);
  std::string bytes;
  if (kind == 7) {
    bytes = kBase.strict;
    damage(bytes, choices);
  } else {
    bytes = (kind < 4 ? loose : strict).changed(kBase.columns, choices);
  }
  std::ofstream(file, std::ios::binary) << bytes;
  // One of the ways to read it for each input, so that there are more inputs a second: those that write a store of
  // their own are dear and come less often.
  const std::size_t way = choices.below(16);
  const auto& named = store::named_queries();
  switch (way) {
    case 0:
      look([&] { store::check_contents(file, [](const std::string&) {}); });
      break;
    case 1:
      look([&] { (void)store::query(file, std::string(named[choices.below(named.size())].sql), kPatience); });
      break;
    case 2:
      look([&] { (void)store::query(file, "SELECT * FROM v_metric_summary", kPatience); });
      break;
    case 3:
      look([&] {
        (void)store::query(file, "SELECT count(*), sum(s.t) FROM main.trial AS t, samples(t.trial) AS s LIMIT 1000",
                           kPatience);
      });
      look([&] { (void)store::query(file, "SELECT * FROM v_trials LIMIT 1000", kPatience); });
      break;
    case 4:
      look([&] {
        fs::remove(kFolder / "out.db");
        (void)store::merge(kFolder / "out.db", {file});
      });
      break;
    case 5:
    case 6:
    case 7:
      look([&] { (void)store::query(file, std::string(named[choices.below(named.size())].sql), kPatience); });
      break;
    default:
      look([&] {
        const store::Reader reader(file);
        look([&] { (void)reader.result_hash(); });
        look([&] { (void)reader.integrity_problems(); });
        look([&] { (void)reader.searched_keys(); });
        for (const std::int64_t id : reader.searches()) look([&] { (void)reader.search(id); });
        for (const store::StoredPoint& point : reader.points()) look([&] { (void)reader.trials_of(point.id); });
        for (const std::string& key : reader.keys()) {
          look([&] { (void)reader.metrics(key); });
          look([&] {
            const store::StoredTrial trial = reader.trial(key);
            if (trial.samples) unpack(*trial.samples);
          });
        }
      });
  }
  return 0;
}
