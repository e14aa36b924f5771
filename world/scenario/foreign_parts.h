#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "controller/config/node.h"
#include "controller/model/shape.h"
#include "controller/types.h"
#include "world/world.h"

/// Problems of other programs (foreign.h) before they are worlds.
namespace moma::foreign {

struct Part {
  Shape shape;
  Isometry X = Isometry::Identity();  ///< in its object's frame
};

/// An object in the hand; without parts, it is the scene's object of the same name.
struct Attached {
  int frame = 0;  ///< link in which the parts stand
  std::vector<Part> parts;
  std::vector<std::string> touch;  ///< links that it may touch
  config::Mark mark;
};
using AttachedObjects = std::map<std::string, Attached>;

struct Scene {
  std::string name;
  std::vector<WorldObject> objects;  ///< X_WO
  AttachedObjects attached;
};

struct Request {
  std::map<std::string, double> start, goal;
  AttachedObjects attached;
  config::Mark mark;
};

/// Returns `name` of a map, or throws an error with the wanted content. Ignores message keys that do not concern
/// shapes.
const config::Node& need(const config::Node& map, const std::string& name, const std::string& what);

/// Returns the list under `name`, empty if there is none.
const std::vector<config::Node>& list_of(const config::Node& map, const std::string& name);

/// Reads one number a letter from a list, or from a map with these keys in turn.
VectorX read_letters(const config::Node& node, const std::string& key, std::string_view letters);

/// Reads `position` and, if given, the quaternion under `key`.
Isometry read_pose(const config::Node& node, const std::string& key = "orientation");

/// Adds an object for each part.
void add(Scene& scene, const std::string& name, const Isometry& X_WO, const std::vector<Part>& parts);

}  // namespace moma::foreign
