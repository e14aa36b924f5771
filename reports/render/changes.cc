#include "reports/render/page_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <utility>

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

/// `[{"key", "from", "to"}]`; null: not set.
Json setting_changes(const Json& from, const Json& to) {
  const auto or_null = [](const std::string* text) { return text == nullptr ? Json(nullptr) : Json(*text); };
  const Settings a = settings_of(from);
  const Settings b = settings_of(to);
  Json changes = Json::array();
  for (const auto& [key, value] : a) {
    const std::string* other = find(b, key);
    if (other == nullptr || *other != value) changes.push_back({{"key", key}, {"from", value}, {"to", or_null(other)}});
  }
  for (const auto& [key, value] : b)
    if (find(a, key) == nullptr) changes.push_back({{"key", key}, {"from", nullptr}, {"to", value}});
  return changes;
}

}  // namespace

void add_changes(Json& page) {
  page["changes"] = Json::array();
  std::map<std::array<std::string, 5>, const Json*> before;
  for (const Json& point : page.at("points")) {
    const auto text = [&](const char* key) { return point.at(key).get<std::string>(); };
    const Json*& last = before[{text("suite"), text("robot"), text("mode"), lineage(point), text("point")}];
    const Json* const earlier = std::exchange(last, &point);
    if (earlier == nullptr) continue;
    page["changes"].push_back({{"suite", point.at("suite")},
                               {"robot", point.at("robot")},
                               {"mode", point.at("mode")},
                               {"controller", point.at("controller")},
                               {"before", earlier->at("controller")},
                               {"differs", setting_changes(*earlier, point)}});
  }
}

}  // namespace moma::reports
