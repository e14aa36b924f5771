#include "eval/store/migrations.h"

#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "eval/store/database.h"

namespace moma::store {

extern const char* const kSchemaSql;
extern const char* const kViewsSql;
extern const char* const kMigrate1To2Sql;
extern const char* const kMigrate2To3Sql;

std::span<const Migration> migrations() noexcept {
  static const Migration kSteps[] = {{1, kMigrate1To2Sql}, {2, kMigrate2To3Sql}};
  return kSteps;
}

int schema_version(SQLite::Database& db) { return db.execAndGet("PRAGMA user_version").getInt(); }

void create_schema(SQLite::Database& db) {
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  // Another process may have been quicker between the look at the file and the lock.
  if (schema_version(db) != 0) return;
  db.exec(kSchemaSql);
  db.exec(kViewsSql);
  db.exec(fmt::format("PRAGMA application_id = {}", kApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kSchemaVersion));
  transaction.commit();
}

void migrate(SQLite::Database& db, std::span<const Migration> steps, int target) {
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  for (int version = schema_version(db); version < target; ++version) {
    const auto step = std::find_if(steps.begin(), steps.end(), [&](const Migration& m) { return m.from == version; });
    if (step == steps.end()) throw std::logic_error(fmt::format("no migration from store version {}", version));
    db.exec(step->sql);
    db.exec(fmt::format("PRAGMA user_version = {}", version + 1));
  }
  db.exec(kViewsSql);
  transaction.commit();
}

}  // namespace moma::store
