#include "eval/store/late.h"

#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <string>

#include "plugin/host/plugin.h"

namespace moma::store {
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
