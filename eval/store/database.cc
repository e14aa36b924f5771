#include "eval/store/database.h"

#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

#include "eval/store/migrations.h"
#include "eval/store/table.h"
#include "plugin/host/plugin.h"

namespace moma::store {
namespace {

using Kind = StoreError::Kind;

constexpr int kBusyTimeoutMs = 10000;

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

// SQLite itself tidies up, under its locks, where a connection that can write looks at the store and closes.
void let_sqlite_tidy(const fs::path& file) noexcept {
  try {
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE);
    (void)db.execAndGet("SELECT count(*) FROM sqlite_schema");
  } catch (const std::exception&) {  // read-only places stay as they are
  }
}

// A run that was killed while it made its store leaves a rollback journal, and in the file anything. Only a connection
// that can write plays it back.
void play_back_journal(const fs::path& file) noexcept {
  constexpr char kMagic[] = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";  // https://sqlite.org/fileformat.html, 3
  std::ifstream journal(file.string() + "-journal", std::ios::binary);
  char head[sizeof kMagic - 1] = {};
  if (journal.read(head, sizeof head) && std::memcmp(head, kMagic, sizeof head) == 0) let_sqlite_tidy(file);
}

/// Faults that can be told before SQLite is asked, in better words than its own. Returns whether the file is there
/// with content.
bool look_at_file(const fs::path& file, Access access) {
  if (file.empty()) throw StoreError(Kind::kUnusable, "the store needs a file name, for instance results/a.db");
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::directory) throw unusable(file, "is a folder; a store is a file, such as a.db");
  if (!fs::exists(status)) {
    if (access != Access::kCreate) throw unusable(file, "no such file; 'moma run SUITE -o DB' makes a store");
    const fs::path folder = folder_of(file);
    if (!fs::is_directory(folder, error)) {
      throw unusable(file, fmt::format("the folder {} does not exist; make it first", folder.string()));
    }
    if (::access(folder.c_str(), W_OK) != 0) {
      throw unusable(file, fmt::format("cannot write in the folder {}: {}; choose another place with -o",
                                       folder.string(), std::strerror(errno)));
    }
    return false;
  }
  if (!fs::is_regular_file(status)) throw unusable(file, "is not a regular file; a store is one");
  play_back_journal(file);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw unusable(file, fmt::format("cannot be read: {}", std::strerror(errno)));
  char head[16] = {};
  stream.read(head, sizeof head);
  if (stream.gcount() == 0 && access == Access::kCreate) return false;
  if (std::memcmp(head, "SQLite format 3", 16) != 0) {
    throw unusable(file, "is not an SQLite database; a store written by 'moma run' is needed");
  }
  if (access != Access::kReadOnly && ::access(file.c_str(), W_OK) != 0) {
    throw unusable(file, fmt::format("cannot be written: {}", std::strerror(errno)));
  }
  return true;
}

/// Guards against a hostile store: triggers (moma makes none) do not run, and its schema is not rewritten
/// by SQL. Functions that do more than compute are not built into SQLite, so that views can call none.
void harden(SQLite::Database& db) {
  for (const auto& [option, value] :
       {std::pair{SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1}})
    sqlite3_db_config(db.getHandle(), option, value, nullptr);
}

/// A view under the name of a table could be of any length.
void check_tables(SQLite::Database& db, const fs::path& file) {
  SQLite::Statement wanted(db, "SELECT type FROM main.sqlite_schema WHERE name = ?");
  for (const char* table : {"robot", "controller", "resolved_suite", "suite", "point", "world", "invocation", "trial",
                            "execution", "point_trial", "samples"}) {
    const std::string type = row<std::string>(wanted, table).value_or("");
    if (type != "table")
      throw unusable(
          file, fmt::format("is damaged: {} {}", table, type.empty() ? "is missing" : "is no table but a " + type));
  }
}

/// Throws unless the file is a store of moma. Returns true for an empty database.
bool check_identity(SQLite::Database& db, const fs::path& file) {
  const int application = db.execAndGet("PRAGMA application_id").getInt();
  const int version = schema_version(db);
  const int tables = db.execAndGet("SELECT count(*) FROM sqlite_schema").getInt();  // fails where the file is damaged
  if (application == 0 && version == 0 && tables == 0) return true;
  if (application != kApplicationId) {
    throw unusable(file, fmt::format("is the database of another program (application_id {}, moma's is {})",
                                     application, kApplicationId));
  }
  if (version > kSchemaVersion) {
    throw unusable(file, fmt::format("was written by a newer moma (store version {}, this program knows up to {}); "
                                     "use that moma",
                                     version, kSchemaVersion));
  }
  check_tables(db, file);
  return false;
}

/// A WAL store in a folder that cannot be written opens only as immutable, which is right if no one is writing.
std::string read_only_uri(const fs::path& file) {
  std::string uri = "file:";
  for (const char c : fs::absolute(file).string()) {
    if (c == '?' || c == '#' || c == '%') {
      uri += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  const bool writable_folder = ::access(folder_of(file).c_str(), W_OK) == 0;
  std::error_code error;
  if (!writable_folder && !fs::exists(file.string() + "-wal", error)) uri += "?immutable=1";
  return uri;
}

// Removes empty -wal and -shm files beside a store that no one has open.
void remove_empty_wal(const fs::path& file) noexcept {
  std::error_code error;
  const auto size = fs::file_size(file.string() + "-wal", error);
  if (!error && size == 0) let_sqlite_tidy(file);
}

}  // namespace

StoreError explain(const SQLite::Exception& error, const fs::path& file, Kind kind) {
  static const std::map<int, const char*> kWords{
      {SQLITE_FULL, "the disk is full"},
      {SQLITE_BUSY, "is locked by another program that is writing to it; try again when it is done"},
      {SQLITE_LOCKED, "is locked by another program that is writing to it; try again when it is done"},
      {SQLITE_READONLY, "cannot be written: the file or its folder is read-only"},
      {SQLITE_NOTADB, "is not an SQLite database; a store written by 'moma run' is needed"},
      {SQLITE_CORRUPT, "is damaged; 'moma verify' tells how far"},
      {SQLITE_CANTOPEN, "cannot be opened"},
      {SQLITE_CONSTRAINT, "holds or would get what breaks a rule of its tables; 'moma verify' tells which"},
      {SQLITE_IOERR, "reading or writing failed (is the disk full or gone?)"}};
  const int code = error.getErrorCode();
  // A lock passes: nothing is wrong with the store or the command.
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) kind = Kind::kInterrupted;
  const auto words = kWords.find(code);
  return {kind, fmt::format("{}: {} (SQLite: {})", file.string(), words != kWords.end() ? words->second : error.what(),
                            error.what())};
}

SQLite::Database open_database(const fs::path& file, Access access) {
  const bool there = look_at_file(file, access);
  try {
    if (access == Access::kReadOnly) {
      SQLite::Database db(read_only_uri(file), SQLite::OPEN_READONLY | SQLITE_OPEN_URI, kBusyTimeoutMs);
      harden(db);
      if (check_identity(db, file))
        throw unusable(file, "is an empty database; a store written by 'moma run' is needed");
      if (schema_version(db) < kSchemaVersion) throw of_older(file);
      shadow_views(db);
      db.exec("PRAGMA query_only = ON");
      return db;
    }
    const int create = access == Access::kCreate ? SQLite::OPEN_CREATE : 0;
    SQLite::Database db(file.string(), SQLite::OPEN_READWRITE | create, kBusyTimeoutMs);
    harden(db);
    const bool empty = check_identity(db, file);
    if (empty && access != Access::kCreate) throw unusable(file, "is an empty database; 'moma run' makes a store");
    db.exec("PRAGMA journal_mode = WAL");
    db.exec("PRAGMA synchronous = NORMAL");
    db.exec("PRAGMA foreign_keys = ON");
    if (empty) {
      create_schema(db);
    } else {
      if (schema_version(db) < kSchemaVersion) migrate(db);
      add_described_columns(db);
    }
    return db;
  } catch (const SQLite::Exception& error) {
    if (!there && access == Access::kCreate) remove_store(file);  // leave nothing half-made behind
    if (access == Access::kReadOnly) remove_empty_wal(file);
    if (error.getErrorCode() == SQLITE_CORRUPT)
      throw unusable(file, fmt::format("is damaged so far that it cannot be opened, as a copy that was cut off is; "
                                       "another copy of it is needed (SQLite: {})",
                                       error.what()));
    throw explain(error, file, Kind::kUnusable);
  }
}

void remove_store(const fs::path& file) {
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + suffix, ignored);
}

ReadConnection::ReadConnection(const fs::path& file) : file_(file), db_(open_database(file, Access::kReadOnly)) {}

ReadConnection::~ReadConnection() {
  db_.reset();
  remove_empty_wal(file_);
}

std::string file_system_warning(const fs::path& file) {
  // Magic numbers of linux/magic.h and statfs(2).
  static const std::map<unsigned long, const char*> kNetworks{
      {0x6969UL, "NFS"},     {0xff534d42UL, "CIFS"},   {0xfe534d42UL, "SMB2"}, {0x517bUL, "SMB"},
      {0x5346414fUL, "AFS"}, {0x0bd00bd0UL, "Lustre"}, {0x47504653UL, "GPFS"}, {0x65735546UL, "FUSE"}};
  struct statfs info {};
  if (::statfs(folder_of(file).c_str(), &info) != 0) return "";
  const auto found = kNetworks.find(static_cast<unsigned long>(info.f_type) & 0xffffffffUL);
  if (found == kNetworks.end()) return "";
  return fmt::format(
      "{}: lies on a network file system ({}), whose locks SQLite cannot trust: write shards to a local "
      "disk and join them with 'moma merge'",
      file.string(), found->second);
}

namespace {

std::string late_trials() {
  return fmt::format("FROM trial WHERE outcome = 'error' AND reason LIKE '%{}%{}%'", kLateBefore, kLateAfter);
}

}  // namespace

std::size_t count_late(const SQLite::Database& db) {
  return static_cast<std::size_t>(
      const_cast<SQLite::Database&>(db).execAndGet("SELECT count(*) " + late_trials()).getInt64());
}

std::size_t forget_late(SQLite::Database& db) {
  const std::size_t late = count_late(db);
  if (late == 0) return 0;
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  for (const char* table : {"samples", "metric_value", "execution", "point_trial"})
    db.exec(fmt::format("DELETE FROM {} WHERE key IN (SELECT key {})", table, late_trials()));
  db.exec("DELETE " + late_trials());
  transaction.commit();
  return late;
}

}  // namespace moma::store
