#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/config/paths.h"

namespace moma::run {

/// A point of a store, found by name.
struct NamedPoint {
  std::int64_t id = 0;
  std::int64_t suite_id = 0;
  std::string suite;  ///< name as shown
  std::string controller;
  std::string label;       ///< "" without a sweep
  std::string conditions;  ///< swept keys other than gains (disturbances, robot, ...), JSON
  std::string why;         ///< for a best point the criterion and its values, else ""

  /// Returns "mine" or "mine:lambda_q=0.02".
  std::string name() const { return label.empty() ? controller : controller + ":" + label; }
};

/// The criterion of @best, in words.
inline constexpr const char* kBestCriterion =
    "the highest success rate, then the lowest collision rate, the shortest mean time to goal, the least command "
    "change, the first that was defined";

/// Returns the points with the name `name`, in the order of their suites. `name` is a controller as shown ("mine",
/// "mine@2"), a point of its sweep ("mine:lambda_q=0.02"), "@best" (the best point of each suite by kBestCriterion over
/// all its worlds), or "mine@best" (the best of one controller). `suite` restricts the search to one suite, unless "".
/// Throws StoreError for the file, and StoreError{kNotFound} with a list of names if there is none.
std::vector<NamedPoint> named_points(const fs::path& store, const std::string& name, const std::string& suite = "");

/// Returns all points of a controller, in the order of their suites. Empty if the controller's name alone is a point's,
/// or if there is no such controller. Throws StoreError for the file.
std::vector<NamedPoint> points_of_controller(const fs::path& store, const std::string& controller,
                                             const std::string& suite = "");

/// Returns the one point of that name. Throws StoreError{kNotFound}, naming the suites, if several have it.
NamedPoint named_point(const fs::path& store, const std::string& name, const std::string& suite = "");

/// Resolves a trial's name: POINT/WORLD is the point's trial in the world of this index; POINT alone is its worst trial
/// (as @worst: not successful and farthest from the goal, else the slowest). Other names come back unchanged.
std::string named_trial(const fs::path& store, const std::string& name);

}  // namespace moma::run
