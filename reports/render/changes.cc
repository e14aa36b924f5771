#include "reports/render/changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <utility>

#include "reports/render/page_data.h"
#include "reports/render/report.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

using Json = nlohmann::ordered_json;
using Settings = std::vector<std::pair<std::string, std::string>>;

constexpr std::array kShared = {"mode",
                                "control_period_s",
                                "physics_step_s",
                                "time_limit_s",
                                "success_position_m",
                                "success_orientation_rad",
                                "success_dwell_s",
                                "simulation_version",
                                "disturbances",
                                "worlds",
                                "robot",
                                "robot_content"};

/// Numbers in their shortest form, so that 1 and 1.0 are the same; texts as they are.
std::string written(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (!value.is_array()) return value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string list;
  for (const Json& item : value) list += (list.empty() ? "" : ", ") + written(item);
  return "[" + list + "]";
}

void flatten(const Json& value, const std::string& key, Settings& out) {
  if (!value.is_object()) {
    if (!key.empty()) out.emplace_back(key, written(value));
    return;
  }
  for (const auto& [name, inner] : value.items()) flatten(inner, key.empty() ? name : key + "." + name, out);
}

Settings settings_of(const Json& point) {
  Settings all;
  flatten(point.at("parameters"), "", all);
  for (const char* key : kShared)
    if (point.contains(key)) flatten(point.at(key), key, all);
  return all;
}

const std::string* find(const Settings& settings, const std::string& key) {
  const auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.first == key; });
  return found == settings.end() ? nullptr : &found->second;
}

std::optional<std::string> copy_of(const std::string* text) {
  return text == nullptr ? std::nullopt : std::optional<std::string>(*text);
}

/// "mine@2 (after)" and "mine (before)" are versions of one controller.
std::string lineage(const Json& point) {
  std::string name = point.at("controller");
  const std::string store = point.contains("store") ? fmt::format(" ({})", point.at("store").get<std::string>()) : "";
  if (!store.empty() && name.ends_with(store)) name.resize(name.size() - store.size());
  const std::size_t at = name.rfind('@');
  const bool numbered = at != std::string::npos && at + 1 < name.size() &&
                        std::all_of(name.begin() + static_cast<std::ptrdiff_t>(at) + 1, name.end(),
                                    [](unsigned char c) { return std::isdigit(c) != 0; });
  if (numbered) name.resize(at);
  return name;
}

Json read_point(const PointName& name) {
  try {
    SQLite::Database store = open_store(name.store);
    for (Json& point : stored_points(store))
      if (point.at("suite") == name.suite && point.at("controller") == name.controller &&
          point.at("point") == name.point)
        return std::move(point);
  } catch (const SQLite::Exception& error) {
    throw ReportError(fmt::format("{}: cannot be read: {}", name.store.string(), error.what()));
  }
  throw ReportError(fmt::format("{}: suite {} has no point {}{}{}", name.store.string(), name.suite, name.controller,
                                name.point.empty() ? "" : ":", name.point));
}

Json or_null(const std::optional<std::string>& text) { return text ? Json(*text) : Json(nullptr); }

}  // namespace

std::vector<SettingChange> setting_changes(const Json& from, const Json& to) {
  const Settings a = settings_of(from);
  const Settings b = settings_of(to);
  std::vector<SettingChange> changes;
  for (const auto& [key, value] : a) {
    const std::string* other = find(b, key);
    if (other == nullptr || *other != value) changes.push_back({key, value, copy_of(other)});
  }
  for (const auto& [key, value] : b)
    if (find(a, key) == nullptr) changes.push_back({key, std::nullopt, value});
  return changes;
}

std::vector<SettingChange> setting_changes(const PointName& from, const PointName& to) {
  return setting_changes(read_point(from), read_point(to));
}

void add_changes(Json& page) {
  page["changes"] = Json::array();
  std::map<std::array<std::string, 5>, const Json*> before;
  for (Json& point : page.at("points")) {
    point["lineage"] = lineage(point);
    const auto text = [&](const char* key) { return point.at(key).get<std::string>(); };
    const Json*& last = before[{text("suite"), text("robot"), text("mode"), text("lineage"), text("point")}];
    const Json* const earlier = std::exchange(last, &point);
    if (earlier == nullptr) continue;
    Json differs = Json::array();
    for (const SettingChange& c : setting_changes(*earlier, point))
      differs.push_back({{"key", c.key}, {"from", or_null(c.from)}, {"to", or_null(c.to)}});
    page["changes"].push_back({{"suite", point.at("suite")},
                               {"robot", point.at("robot")},
                               {"mode", point.at("mode")},
                               {"controller", point.at("controller")},
                               {"before", earlier->at("controller")},
                               {"differs", std::move(differs)}});
  }
}

}  // namespace moma::reports
