#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace moma::run {

/// A point of a store that a person named.
struct NamedPoint {
  std::int64_t id = 0;
  std::int64_t suite_id = 0;
  std::string suite;  ///< as shown
  std::string controller;
  std::string label;       ///< "" without a sweep
  std::string conditions;  ///< what else than gains the suite swept (disturbances, robot, ...), JSON
  std::string why;         ///< of a best one: by what; else ""

  /// "mine", "mine:lambda_q=0.02".
  std::string name() const { return label.empty() ? controller : controller + ":" + label; }
};

/// How @best chooses, in words.
inline constexpr const char* kBestCriterion =
    "the highest success rate, then the lowest collision rate, the shortest mean time to goal, the least command "
    "change, the first that was defined";

/// The points that go by `name`, in the order of their suites: a controller as shown ("mine", "mine@2"); one of its
/// sweep ("mine:lambda_q=0.02"); "@best", the best point of each suite by kBestCriterion over all its worlds;
/// "mine@best", the best of one controller. `suite`: of this one alone, unless "". Throws StoreError for the file and
/// StoreError{kNotFound}, listing names, where there is none.
std::vector<NamedPoint> named_points(const std::filesystem::path& store, const std::string& name,
                                     const std::string& suite = "");

/// All points of a controller, in the order of their suites; none where one of them goes by the controller's name
/// alone, and where there is no such controller. Throws StoreError for the file.
std::vector<NamedPoint> points_of_controller(const std::filesystem::path& store, const std::string& controller,
                                             const std::string& suite = "");

/// The one point of that name. Throws StoreError{kNotFound} where several suites have it, naming them.
NamedPoint named_point(const std::filesystem::path& store, const std::string& name, const std::string& suite = "");

/// The trial that a person means: POINT/WORLD is that point's in the world of this index; POINT alone its worst (as
/// @worst: not successful and farthest from the goal, else the slowest). Everything else comes back as it is.
std::string named_trial(const std::filesystem::path& store, const std::string& name);

}  // namespace moma::run
