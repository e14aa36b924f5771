#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/config/node.h"
#include "controller/model/robot_model.h"
#include "world/world.h"

namespace moma {

/// Problems of a benchmark for arms: scenes of boxes with a list of configurations each, and for every unordered pair
/// i < j of a scene's configurations the problem to come from i to the tool's pose at j. Immutable.
///
///   joints: [shoulder, elbow]             # of the configurations, in their order; all that the robot controls
///   scenes:
///     NAME:
///       base: [x, y, phi]                 # where the robot's base stands
///       boxes: {NAME: {size: [x, y, z], center: [x, y, z]}}      # edges along the world's axes
///       configurations: [[0.1, -0.4], [0.7, 0.2]]
///
/// The scene's name is the worlds' family. What collides at a configuration is left as it is: that is the benchmark's.
class Scenes {
 public:
  struct Scene {
    std::string name;
    Vector3 base = Vector3::Zero();
    std::vector<WorldObject> boxes;
    std::vector<VectorX> configurations;
  };

  /// `node` is a file's path, relative to the file that names it, or a map as in one. Throws config::ConfigError.
  static Scenes read(const config::Node& node, const std::string& key);
  /// As read() takes it back.
  nlohmann::ordered_json to_json() const;

  std::uint64_t size() const { return size_; }
  /// Scene by scene in the file's order, pairs (0, 1), (0, 2), ... Index below size(). Throws GenerationError where the
  /// robot does not have these joints.
  World make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index) const;
  const std::string& family_of(std::uint64_t index) const { return place(index).scene->name; }
  /// What decides the world besides the robot.
  nlohmann::ordered_json identity(std::uint64_t index) const;

 private:
  struct Place {
    const Scene* scene;
    std::size_t from, to;
  };
  Place place(std::uint64_t index) const;

  std::vector<std::string> joints_;
  std::vector<Scene> scenes_;
  std::uint64_t size_ = 0;
};

}  // namespace moma
