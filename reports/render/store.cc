#include "reports/render/store.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <cerrno>
#include <cstdint>

#include "reports/render/report.h"

namespace moma::reports {

namespace {

constexpr int kApplicationId = 1836019041;  // "moma"

constexpr int kDeepest = 100;

/// Encodes the deadline in the pointer itself, because the connection outlives the function that opened it.
int over(void* moment) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count() > reinterpret_cast<std::intptr_t>(moment)
             ? 1
             : 0;
}

void bound(sqlite3* connection, std::chrono::milliseconds patience) {
  sqlite3_db_config(connection, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  const auto end = std::chrono::steady_clock::now().time_since_epoch() + patience;
  const auto moment = std::chrono::duration_cast<std::chrono::milliseconds>(end).count();
  sqlite3_progress_handler(connection, 10000, &over, reinterpret_cast<void*>(static_cast<std::intptr_t>(moment)));
}

/// Reads only, but is opened for writing: the last reader of a store in WAL mode takes away the files that SQLite keeps
/// beside it only where it may write.
SQLite::Database open_read_only(const std::filesystem::path& db) {
  SQLite::Database store(db.string(), SQLite::OPEN_READWRITE);
  store.exec("PRAGMA query_only = ON");
  store.setBusyTimeout(5000);
  store.execAndGet("SELECT count(*) FROM sqlite_schema");  // the first read finds out what the file is
  return store;
}

/// A store in WAL mode needs a shared-memory file beside it, which a read-only folder does not allow. Where nobody
/// can write to the folder nobody can change the store either, so it may be read as it is.
SQLite::Database open_immutable(const std::filesystem::path& db) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(db).string()) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    } else {
      uri += c;
    }
  }
  SQLite::Database store(uri + "?immutable=1", SQLite::OPEN_READONLY | SQLite::OPEN_URI);
  store.execAndGet("SELECT count(*) FROM sqlite_schema");
  return store;
}

}  // namespace

Json parse_stored(const std::string& text) {
  bool deep = false;
  const auto keep = [&](int depth, Json::parse_event_t, const Json&) {
    deep = deep || depth > kDeepest;
    return depth <= kDeepest;
  };
  Json json = Json::parse(text, keep, false);
  if (deep || json.is_discarded()) {
    throw ReportError(fmt::format("the store is damaged: '{}...' is {}", text.substr(0, 40),
                                  deep ? "nested deeper than anything that moma writes" : "no JSON"));
  }
  return json;
}

StoredSamples samples_of(SQLite::Statement& row) {
  const SQLite::Column blob = row.getColumn("data");
  StoredSamples samples;
  samples.layout = row.getColumn("layout").getInt();
  samples.n = row.getColumn("n").getInt64();
  samples.columns = parse_stored(row.getColumn("columns").getString()).get<std::vector<std::string>>();
  samples.data = {static_cast<const char*>(blob.getBlob()), static_cast<std::size_t>(blob.getBytes())};
  return samples;
}

SQLite::Database open_store(const std::filesystem::path& db, std::chrono::milliseconds patience) {
  const std::string name = db.string();
  const auto refusal = [&name](std::string_view what) {
    return ReportError(fmt::format("{}: {}; wanted: a store written by moma run", name, what));
  };
  std::error_code ignored;
  if (!std::filesystem::exists(db, ignored)) throw refusal("there is no such file");
  if (std::filesystem::is_directory(db, ignored)) throw refusal("this is a folder");
  // A FIFO would be waited for.
  if (!std::filesystem::is_regular_file(db, ignored)) throw refusal("this is no regular file");
  try {
    SQLite::Database store = [&] {
      try {
        return open_read_only(db);
      } catch (const SQLite::Exception& error) {
        const bool no_folder_access =
            error.getErrorCode() == SQLITE_CANTOPEN || error.getErrorCode() == SQLITE_READONLY;
        const bool pending = std::filesystem::exists(name + "-wal") && std::filesystem::file_size(name + "-wal") > 0;
        if (!no_folder_access || pending) throw;
        return open_immutable(db);
      }
    }();
    if (store.execAndGet("PRAGMA application_id").getInt() != kApplicationId)
      throw refusal("this SQLite file belongs to another program");
    const int version = store.execAndGet("PRAGMA user_version").getInt();
    if (version > kNewestSchema) {
      throw ReportError(
          fmt::format("{}: a newer moma wrote this store (schema {}, this program knows {}): use that "
                      "version for the report",
                      name, version, kNewestSchema));
    }
    if (version < kOldestSchema) {
      throw ReportError(
          fmt::format("{}: an older moma wrote this store (schema {}, the report wants {} or newer): moma "
                      "run on it brings it up to date",
                      name, version, kOldestSchema));
    }
    for (const char* table : {"point_trial", "trial", "world", "point", "suite", "robot", "samples", "invocation"}) {
      SQLite::Statement found(store, "SELECT 1 FROM main.sqlite_schema WHERE type = 'table' AND name = ?");
      found.bind(1, table);
      if (!found.executeStep()) throw ReportError(fmt::format("{}: is damaged: it has no table {}", name, table));
    }
    bound(store.getHandle(), patience);
    return store;
  } catch (const SQLite::Exception& error) {
    if (error.getErrorCode() == SQLITE_NOTADB) throw refusal("this is not an SQLite file");
    throw ReportError(fmt::format("{}: cannot be read: {}", name, error.what()));
  }
}

Writer writer_of(const std::filesystem::path& db) {
  // A run locks beside the file itself, whatever links lead to it.
  std::error_code error;
  const std::filesystem::path place = std::filesystem::canonical(db, error);
  const int file =
      open(((error ? db : place).string() + "-lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return Writer::kUnknown;
  // Shared: two readers do not take each other for a run.
  const bool free = flock(file, LOCK_SH | LOCK_NB) == 0;
  const bool held = !free && errno == EWOULDBLOCK;
  close(file);
  return free ? Writer::kGone : held ? Writer::kAtWork : Writer::kUnknown;
}

}  // namespace moma::reports
