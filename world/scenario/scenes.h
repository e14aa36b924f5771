#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/model/robot_model.h"
#include "world/world.h"

namespace moma {

/// Benchmark problems for arms: scenes of boxes with a list of configurations each. Every unordered pair i < j of a
/// scene's configurations is the problem of moving from i to the tool's pose at j. Immutable.
///
///   joints: [shoulder, elbow]             # of the configurations, in their order; all that the robot controls
///   scenes:
///     NAME:
///       base: [x, y, phi]                 # pose of the robot's base
///       boxes: {NAME: {size: [x, y, z], center: [x, y, z]}}      # edges along the world's axes
///       configurations: [[0.1, -0.4], [0.7, 0.2]]
///
/// The scene's name is the worlds' family. Configurations in collision stay, as the benchmark has them.
class Scenes {
 public:
  struct Scene {
    std::string name;
    Vector3 base = Vector3::Zero();
    std::vector<WorldObject> boxes;
    std::vector<VectorX> configurations;
  };

  /// `node` is a file's path, relative to the file that names it, or the map of such a file. Throws
  /// config::ConfigError.
  static Scenes read(const config::Node& node, const std::string& key);
  /// Returns the input of read().
  Json to_json() const;

  std::uint64_t size() const { return size_; }
  /// Returns a problem: scene by scene in the file's order, pairs (0, 1), (0, 2), ... Index below size(). Throws
  /// GenerationError if the robot lacks these joints.
  World make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index) const;
  const std::string& family_of(std::uint64_t index) const { return place(index).scene->name; }
  /// Returns all inputs that determine the world besides the robot.
  Json identity(std::uint64_t index) const;

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
