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
#include <string>
#include <system_error>
#include <utility>

#include "eval/store/migrations.h"
#include "eval/store/table.h"
#include "plugin/host/plugin.h"

namespace moma::store {
namespace {

namespace fs = std::filesystem;
using Kind = StoreError::Kind;

constexpr int kBusyTimeoutMs = 10000;

StoreError unusable(const fs::path& file, const std::string& message) {
  return {Kind::kUnusable, fmt::format("{}: {}", file.string(), message)};
}

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

/// What a store from elsewhere may not do to us: triggers (moma makes none) do not run, and its schema is not rewritten
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

/// Refuses what is not ours. True where the file is a database without any content.
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
  std::string message;
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      message = "the disk is full";
      break;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      message = "is locked by another program that is writing to it; try again when it is done";
      kind = Kind::kInterrupted;  // nothing is wrong with the store or the command
      break;
    case SQLITE_READONLY:
      message = "cannot be written: the file or its folder is read-only";
      break;
    case SQLITE_NOTADB:
      message = "is not an SQLite database; a store written by 'moma run' is needed";
      break;
    case SQLITE_CORRUPT:
      message = "is damaged; 'moma verify' tells how far";
      break;
    case SQLITE_CANTOPEN:
      message = "cannot be opened";
      break;
    case SQLITE_CONSTRAINT:
      message = "holds or would get what breaks a rule of its tables; 'moma verify' tells which";
      break;
    case SQLITE_IOERR:
      message = "reading or writing failed (is the disk full or gone?)";
      break;
    default:
      break;
  }
  if (message.empty()) message = error.what();
  return {kind, fmt::format("{}: {} (SQLite: {})", file.string(), message, error.what())};
}

SQLite::Database open_database(const fs::path& file, Access access) {
  const bool there = look_at_file(file, access);
  try {
    if (access == Access::kReadOnly) {
      SQLite::Database db(read_only_uri(file), SQLite::OPEN_READONLY | SQLITE_OPEN_URI, kBusyTimeoutMs);
      harden(db);
      if (check_identity(db, file))
        throw unusable(file, "is an empty database; a store written by 'moma run' is needed");
      if (schema_version(db) < kSchemaVersion) {
        throw unusable(file,
                       "was written by an older moma; 'moma run' on it, or 'moma merge NEW OLD', brings it up to date");
      }
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
      if (schema_version(db) < kSchemaVersion) migrate(db, migrations(), kSchemaVersion);
      add_described_columns(db);
    }
    return db;
  } catch (const SQLite::Exception& error) {
    if (!there && access == Access::kCreate) {  // leave nothing half-made behind
      std::error_code ignored;
      for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + suffix, ignored);
    }
    throw explain(error, file, Kind::kUnusable);
  }
}

ReadConnection::ReadConnection(const fs::path& file) : file_(file), db_(open_database(file, Access::kReadOnly)) {}

ReadConnection::~ReadConnection() {
  db_.reset();
  remove_empty_wal(file_);
}

std::string file_system_warning(const fs::path& file) {
  struct statfs info {};
  if (::statfs(folder_of(file).c_str(), &info) != 0) return "";
  // Magic numbers of linux/magic.h and statfs(2).
  const char* name = nullptr;
  switch (static_cast<unsigned long>(info.f_type) & 0xffffffffUL) {
    case 0x6969UL:
      name = "NFS";
      break;
    case 0xff534d42UL:
      name = "CIFS";
      break;
    case 0xfe534d42UL:
      name = "SMB2";
      break;
    case 0x517bUL:
      name = "SMB";
      break;
    case 0x5346414fUL:
      name = "AFS";
      break;
    case 0x0bd00bd0UL:
      name = "Lustre";
      break;
    case 0x47504653UL:
      name = "GPFS";
      break;
    case 0x65735546UL:
      name = "FUSE";
      break;
    default:
      return "";
  }
  return fmt::format(
      "{}: lies on a network file system ({}), whose locks SQLite cannot trust: write shards to a local "
      "disk and join them with 'moma merge'",
      file.string(), name);
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
