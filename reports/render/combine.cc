#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "reports/render/page_data.h"

namespace moma::reports {
namespace {

using Texts = std::vector<std::string>;

void add_once(Texts& names, const std::string& name) {
  if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

/// Common name of all stores' suites; empty if their own names stay.
std::string common_suite(const std::vector<Json>& pages) {
  Texts names;
  for (const Json& page : pages) {
    const Texts own = suites_of(page);
    if (own.size() > 1) return "";
    for (const std::string& name : own) add_once(names, name);
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

/// The cell of a column of trials, whatever its form.
Json cell_of(const Json& column, std::size_t row) {
  if (column.is_array()) return column.at(row);
  const int code = column.at("codes").at(row).get<int>();
  return code < 0 ? Json(nullptr) : column.at("values").at(static_cast<std::size_t>(code));
}

Json joined_trials(const std::vector<Json>& pages, const std::vector<Names>& names) {
  std::map<std::string, TrialColumn> columns;
  columns["store"];
  std::size_t total = 0;
  std::int64_t stored = 0;
  std::int64_t worlds = 0;
  for (const Json& page : pages) {
    const Json& trials = page.at("trials");
    for (const auto& [name, column] : trials.at("columns").items()) columns[name];
    total += trials.at("n").get<std::size_t>();
    stored += trials.at("stored").get<std::int64_t>();
    worlds = std::max(worlds, trials.at("worlds").get<std::int64_t>());
  }
  for (std::size_t i = 0; i < pages.size(); ++i) {
    const auto n = pages[i].at("trials").at("n").get<std::size_t>();
    const Json& own = pages[i].at("trials").at("columns");
    for (auto& [name, column] : columns) {
      for (std::size_t row = 0; row < n; ++row) {
        Json cell = own.contains(name) ? cell_of(own.at(name), row) : nullptr;
        if (name == "controller") cell = names[i].controller_of(cell_of(own.at("suite"), row), cell);
        if (name == "suite") cell = names[i].suite_of(cell);
        if (name == "store") cell = names[i].label;
        column.add(std::move(cell), name == "store" || (own.contains(name) && own.at(name).is_object()));
      }
    }
  }
  Json joined = Json::object();
  for (auto& [name, column] : columns) joined[name] = column.take();
  return {{"n", total}, {"stored", stored}, {"worlds", worlds}, {"columns", std::move(joined)}};
}

}  // namespace

Texts suites_of(const Json& page) {
  Texts names;
  for (const Json& point : page.at("points")) add_once(names, point.at("suite"));
  return names;
}

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
  return all;
}

}  // namespace moma::reports
