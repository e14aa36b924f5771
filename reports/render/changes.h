#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace moma::reports {

/// A setting that two points do not share; nothing: it is not set.
struct SettingChange {
  std::string key;  ///< "collision.stop", "mode", "worlds.seed"
  std::optional<std::string> from;
  std::optional<std::string> to;
};

/// Everything in which `to` is set otherwise than `from`, gains first: rows of points.sql, in whose `parameters` gains
/// are, and disturbances, worlds, times, tolerances and robot beside them. Numbers that are equal are no change,
/// however they are written.
std::vector<SettingChange> setting_changes(const nlohmann::ordered_json& from, const nlohmann::ordered_json& to);

/// A point by its names as shown; `point` is "" without a sweep.
struct PointName {
  std::filesystem::path store;
  std::string suite;
  std::string controller;
  std::string point;
};

/// The same of two points, of one store or of two. Throws ReportError: no such store, no such point in it.
std::vector<SettingChange> setting_changes(const PointName& from, const PointName& to);

/// Gives each of the page's points its `lineage`, the controller's name without the store or number that tells its
/// versions apart, and the page its `changes`: each version of a controller at a sweep point against the one before.
void add_changes(nlohmann::ordered_json& page);

}  // namespace moma::reports
