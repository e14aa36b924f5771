#include "eval/store/pair_counts.h"

#include <SQLiteCpp/Exception.h>
#include <sqlite3.h>

#include <bit>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "eval/store/statement.h"
#include "eval/store/virtual_table.h"

// An eponymous virtual table: https://sqlite.org/vtab.html#epovtab.
namespace moma::store {
namespace {

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

struct PairRow {
  const PointBits* a = nullptr;
  const PointBits* b = nullptr;
  std::size_t family = 0;
  std::int64_t n = 0, both = 0, only_a = 0, only_b = 0;
};

struct PairTable : sqlite3_vtab {
  sqlite3* connection = nullptr;
};

struct PairCursor : sqlite3_vtab_cursor {
  std::vector<PointBits> points;
  WorldOrder worlds;
  std::vector<PairRow> rows;
  std::int64_t row = 0;

  std::int64_t size() const { return static_cast<std::int64_t>(rows.size()); }
};
using PairCounts = VirtualTable<PairTable, PairCursor>;

WorldOrder read_worlds(sqlite3* connection) {
  WorldOrder order;
  const StatementPtr query = prepare_statement(connection, "SELECT id, family FROM world ORDER BY family, id");
  std::size_t next = 0;
  while (step(connection, query.get())) {
    std::string family = column_text(query.get(), 1);
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
  const StatementPtr query =
      prepare_statement(connection,
                        "SELECT p.id, s.name, p.mode, p.controller, p.label, p.suite_id, p.robot_id "
                        "FROM point AS p JOIN suite AS s ON s.id = p.suite_id ORDER BY p.id");
  while (step(connection, query.get())) {
    place.emplace(sqlite3_column_int64(query.get(), 0), points.size());
    points.push_back({column_text(query.get(), 1), column_text(query.get(), 2), column_text(query.get(), 3),
                      column_text(query.get(), 4), sqlite3_column_int64(query.get(), 5),
                      sqlite3_column_int64(query.get(), 6), Words(worlds.first_word.back(), 0),
                      Words(worlds.first_word.back(), 0)});
  }
  const StatementPtr trials =
      prepare_statement(connection, "SELECT point_id, world_id, outcome = 'success' FROM point_trial");
  while (step(connection, trials.get())) {
    PointBits& point = points.at(place.at(sqlite3_column_int64(trials.get(), 0)));
    const std::size_t bit = worlds.bit.at(sqlite3_column_int64(trials.get(), 1));
    point.met[bit / 64] |= std::uint64_t{1} << (bit % 64);
    if (sqlite3_column_int(trials.get(), 2) != 0) point.won[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  return points;
}

void count(PairCursor& cursor) {
  for (std::size_t i = 0; i < cursor.points.size(); ++i) {
    const PointBits& a = cursor.points[i];
    for (std::size_t j = i + 1; j < cursor.points.size(); ++j) {
      const PointBits& b = cursor.points[j];
      if (std::tie(a.suite_id, a.robot_id, a.mode) != std::tie(b.suite_id, b.robot_id, b.mode)) continue;
      for (std::size_t f = 0; f < cursor.worlds.families.size(); ++f) {
        PairRow row{&a, &b, f};
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
            char** error) {
  return guarded(*error, [&] {
    auto table = std::make_unique<PairTable>();
    table->connection = connection;
    const int code = sqlite3_declare_vtab(connection,
                                          "CREATE TABLE pair_counts (suite TEXT, family TEXT, mode TEXT, "
                                          "controller_a TEXT, point_a TEXT, controller_b TEXT, point_b TEXT, "
                                          "n INTEGER, both INTEGER, only_a INTEGER, only_b INTEGER, neither INTEGER)");
    if (code == SQLITE_OK) *out = table.release();
    return code;
  });
}

int best_index(sqlite3_vtab* /*table*/, sqlite3_index_info* info) {
  info->estimatedCost = 1e6;
  return SQLITE_OK;
}

int filter(sqlite3_vtab_cursor* base, int /*number*/, const char* /*text*/, int /*argc*/, sqlite3_value** /*argv*/) {
  PairCursor& cursor = PairCounts::cursor(base);
  sqlite3* const connection = PairCounts::table(base->pVtab).connection;
  return guarded(base->pVtab->zErrMsg, [&] {
    cursor.rows.clear();
    cursor.row = 0;
    cursor.worlds = read_worlds(connection);
    cursor.points = read_points(connection, cursor.worlds);
    count(cursor);
    return SQLITE_OK;
  });
}

int column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  const PairCursor& cursor = PairCounts::cursor(base);
  const PairRow& r = cursor.rows[static_cast<std::size_t>(cursor.row)];
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

sqlite3_module make_module() {
  sqlite3_module module = PairCounts::module();  // without xCreate: there is one such table, under the module's name
  module.xConnect = &connect;
  module.xBestIndex = &best_index;
  module.xFilter = &filter;
  module.xColumn = &column;
  return module;
}

}  // namespace

void add_pair_counts(sqlite3* connection) {
  static const sqlite3_module kModule = make_module();
  if (sqlite3_create_module_v2(connection, "pair_counts", &kModule, nullptr, nullptr) != SQLITE_OK)
    throw SQLite::Exception(connection);
}

}  // namespace moma::store
