#include "reports/render/page_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "reports/render/assets.h"
#include "reports/render/evidence.h"
#include "reports/render/own_metrics.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

Json number(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return nullptr;
  return value > 0 ? "inf" : "-inf";
}

Json value(const SQLite::Column& cell) {
  if (cell.isNull()) return nullptr;
  if (cell.isInteger()) return cell.getInt64();
  if (cell.isFloat()) return number(cell.getDouble());
  return cell.getString();  // may hold anything, for instance bytes that are not UTF-8: dump() replaces those
}

SQLite::Statement prepare(SQLite::Database& store, std::string_view sql) {
  return SQLite::Statement(store, std::string(sql));
}

/// One object per row; a column named json_NAME becomes NAME, parsed. `id` is the query's ?1, where it has one.
Json rows(SQLite::Database& store, std::string_view sql, std::optional<std::int64_t> id = {}) {
  static constexpr std::string_view kPrefix = "json_";
  Json all = Json::array();
  SQLite::Statement query = prepare(store, sql);
  if (id) query.bind(1, *id);
  while (query.executeStep()) {
    Json row = Json::object();
    for (int i = 0; i < query.getColumnCount(); ++i) {
      const std::string_view name = query.getColumnName(i);
      const SQLite::Column cell = query.getColumn(i);
      if (name.substr(0, kPrefix.size()) == kPrefix) {
        row[std::string(name.substr(kPrefix.size()))] = parse_stored(cell.getString());
      } else {
        row[std::string(name)] = value(cell);
      }
    }
    all.push_back(std::move(row));
  }
  return all;
}

struct Extent {
  std::int64_t trials = 0;  // in the store
  std::int64_t worlds = 0;  // of each point that are shown
};

Extent extent(SQLite::Database& store, std::int64_t most) {
  SQLite::Statement query = prepare(store, extent_sql());
  query.bind(1, most);
  query.executeStep();
  return {query.getColumn(0).getInt64(), query.getColumn(1).getInt64()};
}

/// The columns of a world's difficulty, "w.goal_distance_m, w.objects, ...".
std::string difficulty() {
  std::string list;
  for (const Json& metric : Json::parse(metrics_json()))
    if (metric.at("of") == "world") list += (list.empty() ? "w." : ", w.") + metric.at("key").get<std::string>();
  return list;
}

std::string all_trials_sql(const OwnMetrics& own) {
  static constexpr std::string_view kPlace = "{{difficulty}}";
  std::string sql(trials_sql());
  return sql.replace(sql.find(kPlace), kPlace.size(), difficulty() + own.columns);
}

/// Rows by column.
Json columns_of(SQLite::Statement& query, long long& n) {
  std::vector<TrialColumn> columns(static_cast<std::size_t>(query.getColumnCount()));
  for (n = 0; query.executeStep(); ++n) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const SQLite::Column cell = query.getColumn(static_cast<int>(i));
      columns[i].add(value(cell), cell.isText());
    }
  }
  Json all = Json::object();
  for (std::size_t i = 0; i < columns.size(); ++i) all[query.getColumnName(static_cast<int>(i))] = columns[i].take();
  all.erase("params");  // swept values are with the points
  return all;
}

Json trials(SQLite::Database& store, const Extent& extent, const OwnMetrics& own) {
  SQLite::Statement query = prepare(store, all_trials_sql(own));
  query.bind(1, extent.worlds);
  long long n = 0;
  Json columns = columns_of(query, n);
  return {{"n", n}, {"stored", extent.trials}, {"worlds", extent.worlds}, {"columns", std::move(columns)}};
}

/// Data that every page has.
Json begin(SQLite::Database& store) {
  Json page = Json::object();
  page["format"] = 1;
  page["store"] = {{"file", std::filesystem::path(store.getFilename()).filename().string()},
                   {"schema", store.execAndGet("PRAGMA user_version").getInt()}};
  page["metrics"] = Json::parse(metrics_json());
  page["outcomes"] = Json::parse(outcomes_json());
  page["words"] = Json::parse(samples_json());
  page["points"] = rows(store, points_sql());
  return page;
}

/// Geometry of the page's robots by their ids; of all robots of the store if motions are requested later.
void add_looks(SQLite::Database& store, const ReportOptions& options, Json& page) {
  page["looks"] = Json::object();
  if (!options.look) return;
  Json robots = page.at("robots");
  if (options.served) {
    SQLite::Statement query(store, "SELECT CAST(id AS TEXT), resolved FROM robot");
    while (query.executeStep()) robots[query.getColumn(0).getString()] = parse_stored(query.getColumn(1).getString());
  }
  for (const auto& [id, robot] : robots.items()) {
    Json look = mesh_data(options.look(robot));
    if (!look.empty()) page["looks"][id] = std::move(look);
  }
}

/// Runs and searches without an end, the latest first.
void add_ends(const std::filesystem::path& db, Json& rows) {
  bool latest = true;
  for (Json& row : rows) {
    if (row.at("status") == "running") {
      const Writer writer = latest ? writer_of(db) : Writer::kGone;
      row["writer"] = writer == Writer::kAtWork ? "at work" : writer == Writer::kGone ? "gone" : "unknown";
    }
    latest = false;
  }
}

Json tuning(SQLite::Database& store) {
  Json searches = rows(store, tuning_sql());
  std::reverse(searches.begin(), searches.end());  // the latest first, as add_ends() wants them
  add_ends(store.getFilename(), searches);
  std::reverse(searches.begin(), searches.end());
  for (Json& search : searches) {
    const std::int64_t id = search.at("id").get<std::int64_t>();
    search["variables"] = rows(store, tuning_variables_sql(), id);
    search["evaluations"] = rows(store, tuning_evaluations_sql(), id);
    search["sensitivity"] = rows(store, tuning_sensitivity_sql(), id);
    search["comparisons"] = rows(store, tuning_comparisons_sql(), id);
  }
  return searches;
}

}  // namespace

void TrialColumn::add(Json cell, bool is_text) {
  if (is_text && !is_text_) {
    is_text_ = true;
    codes_ = std::vector<int>(numbers_.size(), -1);
  }
  if (!is_text_) {
    numbers_.push_back(std::move(cell));
  } else if (cell.is_null()) {
    codes_.push_back(-1);
  } else {
    const auto [place, added] = known_.try_emplace(cell.get<std::string>(), static_cast<int>(known_.size()));
    if (added) values_.push_back(place->first);
    codes_.push_back(place->second);
  }
}

Json TrialColumn::take() {
  if (!is_text_) return std::move(numbers_);
  return {{"values", std::move(values_)}, {"codes", std::move(codes_)}};
}

Json page_data(SQLite::Database& store, const ReportOptions& options) {
  // One transaction: all parts show the store at one moment, whatever a run adds meanwhile.
  SQLite::Transaction snapshot(store);
  Json page = begin(store);
  page["invocations"] = rows(store, invocations_sql());
  add_ends(store.getFilename(), page["invocations"]);
  page["summary"] = rows(store, summary_sql());
  page["overall"] = rows(store, overall_sql());
  for (Json& row : page["overall"]) row["family"] = nullptr;
  const OwnMetrics own = page_metrics(store);
  for (const Json& metric : own.described) page["metrics"].push_back(metric);
  add_own_means(store, own, page);
  const Extent shown = extent(store, options.trials);
  page["trials"] = trials(store, shown, own);
  add_evidence(store, shown.worlds, options.time_known, page);
  page["tuning"] = tuning(store);
  page["samples_stored"] = store.execAndGet("SELECT count(*) FROM samples").getInt64();
  add_replays(store, options, shown.worlds, page);
  add_looks(store, options, page);
  return page;
}

}  // namespace moma::reports
