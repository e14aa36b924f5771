#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "reports/render/page_data.h"

namespace moma::reports {
namespace {

using Json = nlohmann::ordered_json;
using Texts = std::vector<std::string>;

Texts suites_of(const Json& page) {
  Texts names;
  for (const Json& point : page.at("points")) {
    const std::string name = point.at("suite");
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

/// What all stores' suites are called together; empty where their own names stay.
std::string common_suite(const std::vector<Json>& pages) {
  Texts names;
  for (const Json& page : pages) {
    const Texts own = suites_of(page);
    if (own.size() > 1) return "";
    for (const std::string& name : own) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return fmt::format("{}", fmt::join(names, " + "));
}

/// New names of the suites and controllers of one store.
struct Names {
  std::string suite;                             ///< empty: as they were
  std::string label;                             ///< of the store
  std::set<std::array<std::string, 2>> renamed;  ///< suite as it was, controller

  std::string suite_of(const std::string& was) const { return suite.empty() ? was : suite; }
  std::string controller_of(const std::string& was_suite, const std::string& controller) const {
    return renamed.count({was_suite, controller}) ? fmt::format("{} ({})", controller, label) : controller;
  }
  void rename(Json& row) const {
    const std::string was = row.at("suite");
    if (row.contains("controller")) row["controller"] = controller_of(was, row.at("controller"));
    row["suite"] = suite_of(was);
    row["store"] = label;
  }
};

std::array<std::string, 2> key(const std::string& suite, const Json& point) {
  return {suite, point.at("controller").get<std::string>()};
}

std::vector<Names> new_names(const std::vector<Json>& pages, const Texts& labels) {
  const std::string suite = common_suite(pages);
  std::vector<Names> names(pages.size());
  std::map<std::array<std::string, 2>, std::set<std::size_t>> holders;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    names[i].suite = suite;
    names[i].label = labels[i];
    for (const Json& point : pages[i].at("points")) {
      holders[key(names[i].suite_of(point.at("suite")), point)].insert(i);
    }
  }
  for (std::size_t i = 0; i < pages.size(); ++i) {
    for (const Json& point : pages[i].at("points")) {
      if (holders[key(names[i].suite_of(point.at("suite")), point)].size() > 1) {
        names[i].renamed.insert(key(point.at("suite"), point));
      }
    }
  }
  return names;
}

/// The cells of a column of trials, whatever their form.
Json cells(const Json& column, std::size_t n) {
  if (column.is_array()) return column;
  Json out = Json::array();
  for (std::size_t row = 0; row < n; ++row) {
    const int code = column.at("codes").at(row).get<int>();
    out.push_back(code < 0 ? Json(nullptr) : column.at("values").at(static_cast<std::size_t>(code)));
  }
  return out;
}

/// A column of texts as page_data() writes it.
Json coded(const Json& all) {
  Json values = Json::array();
  Json codes = Json::array();
  std::map<std::string, int> known;
  for (const Json& cell : all) {
    if (cell.is_null()) {
      codes.push_back(-1);
      continue;
    }
    const auto [place, added] = known.try_emplace(cell.get<std::string>(), static_cast<int>(known.size()));
    if (added) values.push_back(place->first);
    codes.push_back(place->second);
  }
  return {{"values", std::move(values)}, {"codes", std::move(codes)}};
}

void rename_trials(Json& columns, std::size_t n, const Names& names) {
  Json suites = cells(columns.at("suite"), n);
  Json controllers = cells(columns.at("controller"), n);
  for (std::size_t row = 0; row < n; ++row) {
    const std::string was = suites[row];
    controllers[row] = names.controller_of(was, controllers[row]);
    suites[row] = names.suite_of(was);
  }
  columns["suite"] = std::move(suites);
  columns["controller"] = std::move(controllers);
  columns["store"] = Json(n, names.label);
}

Json joined_trials(std::vector<Json>& pages, const std::vector<Names>& names) {
  std::set<std::string> columns;
  long long total = 0;
  std::int64_t stored = 0;
  std::int64_t worlds = 0;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    Json& trials = pages[i].at("trials");
    const auto n = trials.at("n").get<std::size_t>();
    if (n > 0) rename_trials(trials.at("columns"), n, names[i]);
    for (const auto& [name, column] : trials.at("columns").items()) columns.insert(name);
    total += static_cast<long long>(n);
    stored += trials.at("stored").get<std::int64_t>();
    worlds = std::max(worlds, trials.at("worlds").get<std::int64_t>());
  }
  Json joined = Json::object();
  for (const std::string& name : columns) {
    Json all = Json::array();
    bool is_text = name == "suite" || name == "controller" || name == "store";
    for (const Json& page : pages) {
      const auto n = page.at("trials").at("n").get<std::size_t>();
      const Json& own = page.at("trials").at("columns");
      is_text = is_text || (own.contains(name) && own.at(name).is_object());
      const Json part = own.contains(name) ? cells(own.at(name), n) : Json(n, nullptr);
      all.insert(all.end(), part.begin(), part.end());
    }
    joined[name] = is_text ? coded(all) : std::move(all);
  }
  return {{"n", total}, {"stored", stored}, {"worlds", worlds}, {"columns", std::move(joined)}};
}

}  // namespace

Json combined(std::vector<Json> pages, const Texts& labels) {
  const std::vector<Names> names = new_names(pages, labels);
  Json all = pages.front();
  all["stores"] = Json::array();
  for (const char* part : {"invocations", "points", "summary", "overall", "tuning", "replays"})
    all[part] = Json::array();
  all["robots"] = Json::object();
  all["looks"] = Json::object();
  all["samples_stored"] = 0;
  all["store"]["file"] = fmt::format("{}", fmt::join(labels, " + "));
  std::set<std::string> metrics;
  for (const Json& metric : all["metrics"]) metrics.insert(metric.at("key").get<std::string>());
  for (std::size_t i = 0; i < pages.size(); ++i) {
    Json& page = pages[i];
    for (const Json& metric : page.at("metrics"))  // suites have metrics of their own
      if (metrics.insert(metric.at("key").get<std::string>()).second) all["metrics"].push_back(metric);
    all["stores"].push_back({{"label", labels[i]}, {"file", page.at("store").at("file")}});
    for (const char* part : {"invocations", "points", "summary", "overall", "tuning"}) {
      for (Json& row : page.at(part)) {
        names[i].rename(row);
        all[part].push_back(std::move(row));
      }
    }
    const std::string prefix = fmt::format("{}:", i);
    for (Json& replay : page.at("replays")) {
      if (replay.contains("robot")) replay["robot"] = prefix + replay.at("robot").get<std::string>();
      replay["store"] = labels[i];
      all["replays"].push_back(std::move(replay));
    }
    for (const char* part : {"robots", "looks"})
      for (auto& [id, robot] : page.at(part).items()) all[part][prefix + id] = std::move(robot);
    all["samples_stored"] = all["samples_stored"].get<long long>() + page.at("samples_stored").get<long long>();
  }
  // Families together, as v_summary has them.
  std::stable_sort(all["summary"].begin(), all["summary"].end(), [](const Json& a, const Json& b) {
    return a.at("family").get<std::string>() < b.at("family").get<std::string>();
  });
  all["trials"] = joined_trials(pages, names);
  add_changes(all);
  return all;
}

}  // namespace moma::reports
