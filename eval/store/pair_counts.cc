#include "eval/store/pair_counts.h"

#include <SQLiteCpp/Exception.h>
#include <sqlite3.h>

#include <bit>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

// An eponymous virtual table: https://sqlite.org/vtab.html#epovtab.
namespace moma::store {
namespace {

struct Finalizer {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalizer>;

Statement prepare(sqlite3* connection, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(connection, sql, -1, &raw, nullptr) != SQLITE_OK)
    throw std::runtime_error(sqlite3_errmsg(connection));
  return Statement(raw);
}

/// The next row; false at the end.
bool step(sqlite3* connection, sqlite3_stmt* statement) {
  const int code = sqlite3_step(statement);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  throw std::runtime_error(sqlite3_errmsg(connection));
}

std::string text(sqlite3_stmt* statement, int column) {
  const auto* words = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return words == nullptr ? std::string() : words;
}

using Words = std::vector<std::uint64_t>;

struct PointBits {
  std::string suite, mode, controller, label;
  std::int64_t suite_id = 0;
  std::int64_t robot_id = 0;
  Words met;
  Words won;
};

/// Worlds in the order of their families, each family beginning with a new word.
struct WorldOrder {
  std::unordered_map<std::int64_t, std::size_t> bit;  // of a world's id
  std::vector<std::string> families;
  std::vector<std::size_t> first_word;  // of each family, and the end
};

struct Row {
  const PointBits* a = nullptr;
  const PointBits* b = nullptr;
  std::size_t family = 0;
  std::int64_t n = 0, both = 0, only_a = 0, only_b = 0;
};

struct Table : sqlite3_vtab {
  sqlite3* connection = nullptr;
};

struct Cursor : sqlite3_vtab_cursor {
  std::vector<PointBits> points;
  WorldOrder worlds;
  std::vector<Row> rows;
  std::size_t row = 0;
};

WorldOrder read_worlds(sqlite3* connection) {
  WorldOrder order;
  const Statement query = prepare(connection, "SELECT id, family FROM world ORDER BY family, id");
  std::size_t next = 0;
  while (step(connection, query.get())) {
    std::string family = text(query.get(), 1);
    if (order.families.empty() || order.families.back() != family) {
      next = (next + 63) / 64 * 64;
      order.families.push_back(std::move(family));
      order.first_word.push_back(next / 64);
    }
    order.bit.emplace(sqlite3_column_int64(query.get(), 0), next++);
  }
  order.first_word.push_back((next + 63) / 64);
  return order;
}

std::vector<PointBits> read_points(sqlite3* connection, const WorldOrder& worlds) {
  std::vector<PointBits> points;
  std::map<std::int64_t, std::size_t> place;
  const Statement query = prepare(connection,
                                  "SELECT p.id, s.name, p.mode, p.controller, p.label, p.suite_id, p.robot_id "
                                  "FROM point AS p JOIN suite AS s ON s.id = p.suite_id ORDER BY p.id");
  while (step(connection, query.get())) {
    place.emplace(sqlite3_column_int64(query.get(), 0), points.size());
    points.push_back({text(query.get(), 1), text(query.get(), 2), text(query.get(), 3), text(query.get(), 4),
                      sqlite3_column_int64(query.get(), 5), sqlite3_column_int64(query.get(), 6),
                      Words(worlds.first_word.back(), 0), Words(worlds.first_word.back(), 0)});
  }
  const Statement trials = prepare(connection, "SELECT point_id, world_id, outcome = 'success' FROM point_trial");
  while (step(connection, trials.get())) {
    PointBits& point = points.at(place.at(sqlite3_column_int64(trials.get(), 0)));
    const std::size_t bit = worlds.bit.at(sqlite3_column_int64(trials.get(), 1));
    point.met[bit / 64] |= std::uint64_t{1} << (bit % 64);
    if (sqlite3_column_int(trials.get(), 2) != 0) point.won[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  return points;
}

void count(Cursor& cursor) {
  for (std::size_t i = 0; i < cursor.points.size(); ++i) {
    const PointBits& a = cursor.points[i];
    for (std::size_t j = i + 1; j < cursor.points.size(); ++j) {
      const PointBits& b = cursor.points[j];
      if (std::tie(a.suite_id, a.robot_id, a.mode) != std::tie(b.suite_id, b.robot_id, b.mode)) continue;
      for (std::size_t f = 0; f < cursor.worlds.families.size(); ++f) {
        Row row{&a, &b, f};
        for (std::size_t w = cursor.worlds.first_word[f]; w < cursor.worlds.first_word[f + 1]; ++w) {
          const std::uint64_t met = a.met[w] & b.met[w];
          row.n += std::popcount(met);
          row.both += std::popcount(met & a.won[w] & b.won[w]);
          row.only_a += std::popcount(met & a.won[w] & ~b.won[w]);
          row.only_b += std::popcount(met & b.won[w] & ~a.won[w]);
        }
        if (row.n > 0) cursor.rows.push_back(row);
      }
    }
  }
}

int connect(sqlite3* connection, void* /*data*/, int /*argc*/, const char* const* /*argv*/, sqlite3_vtab** out,
            char** /*error*/) {
  auto* table = new (std::nothrow) Table;
  if (table == nullptr) return SQLITE_NOMEM;
  table->connection = connection;
  const int code = sqlite3_declare_vtab(connection,
                                        "CREATE TABLE pair_counts (suite TEXT, family TEXT, mode TEXT, "
                                        "controller_a TEXT, point_a TEXT, controller_b TEXT, point_b TEXT, "
                                        "n INTEGER, both INTEGER, only_a INTEGER, only_b INTEGER, neither INTEGER)");
  if (code != SQLITE_OK) {
    delete table;
    return code;
  }
  *out = table;
  return SQLITE_OK;
}

int disconnect(sqlite3_vtab* table) {
  delete static_cast<Table*>(table);
  return SQLITE_OK;
}

int best_index(sqlite3_vtab* /*table*/, sqlite3_index_info* info) {
  info->estimatedCost = 1e6;
  return SQLITE_OK;
}

int open(sqlite3_vtab* /*table*/, sqlite3_vtab_cursor** out) {
  auto* cursor = new (std::nothrow) Cursor;
  *out = cursor;
  return cursor == nullptr ? SQLITE_NOMEM : SQLITE_OK;
}

int close(sqlite3_vtab_cursor* cursor) {
  delete static_cast<Cursor*>(cursor);
  return SQLITE_OK;
}

int filter(sqlite3_vtab_cursor* base, int /*number*/, const char* /*text*/, int /*argc*/, sqlite3_value** /*argv*/) {
  auto& cursor = *static_cast<Cursor*>(base);
  sqlite3* const connection = static_cast<const Table*>(base->pVtab)->connection;
  try {
    cursor.rows.clear();
    cursor.row = 0;
    cursor.worlds = read_worlds(connection);
    cursor.points = read_points(connection, cursor.worlds);
    count(cursor);
    return SQLITE_OK;
  } catch (const std::bad_alloc&) {
    return SQLITE_NOMEM;
  } catch (const std::exception& failure) {
    sqlite3_free(base->pVtab->zErrMsg);
    base->pVtab->zErrMsg = sqlite3_mprintf("%s", failure.what());
    return SQLITE_ERROR;
  }
}

int next(sqlite3_vtab_cursor* base) {
  ++static_cast<Cursor*>(base)->row;
  return SQLITE_OK;
}

int at_end(sqlite3_vtab_cursor* base) {
  const auto& cursor = *static_cast<const Cursor*>(base);
  return cursor.row >= cursor.rows.size() ? 1 : 0;
}

int column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  const auto& cursor = *static_cast<const Cursor*>(base);
  const Row& r = cursor.rows[cursor.row];
  const std::string* const texts[] = {
      &r.a->suite, &cursor.worlds.families[r.family], &r.a->mode, &r.a->controller, &r.a->label, &r.b->controller,
      &r.b->label};
  const std::int64_t numbers[] = {r.n, r.both, r.only_a, r.only_b, r.n - r.both - r.only_a - r.only_b};
  if (index < 7) {
    sqlite3_result_text(context, texts[index]->c_str(), -1, SQLITE_TRANSIENT);
  } else {
    sqlite3_result_int64(context, numbers[index - 7]);
  }
  return SQLITE_OK;
}

int rowid(sqlite3_vtab_cursor* base, sqlite3_int64* out) {
  *out = static_cast<sqlite3_int64>(static_cast<const Cursor*>(base)->row);
  return SQLITE_OK;
}

sqlite3_module make_module() {
  sqlite3_module module{};  // without xCreate: there is one such table, under the module's name
  module.xConnect = &connect;
  module.xBestIndex = &best_index;
  module.xDisconnect = &disconnect;
  module.xOpen = &open;
  module.xClose = &close;
  module.xFilter = &filter;
  module.xNext = &next;
  module.xEof = &at_end;
  module.xColumn = &column;
  module.xRowid = &rowid;
  return module;
}

}  // namespace

void add_pair_counts(sqlite3* connection) {
  static const sqlite3_module kModule = make_module();
  if (sqlite3_create_module_v2(connection, "pair_counts", &kModule, nullptr, nullptr) != SQLITE_OK)
    throw SQLite::Exception(connection);
}

}  // namespace moma::store
