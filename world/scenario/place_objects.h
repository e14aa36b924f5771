#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "world/scenario/scene_builder.h"

namespace moma {

/// One draw of one object.
struct ObjectTry {
  int number = 0;          ///< of the tries before it at this object
  std::uint64_t item = 1;  ///< its own item for SceneBuilder::draws(); 0 is left for what all objects share
};

struct ObjectPlacing {
  int count = 0;             ///< of objects
  int tries = 1;             ///< for each of them
  std::string name;          ///< they are called NAME1, NAME2 ... where nothing else names them
  std::string drawn_again;   ///< what it counts as where an object is drawn once more,
  std::string out_of_tries;  ///< and where there is no place for it

  /// Adds the objects to the world one after another. `draw` draws one, and says whether it may stay; what it leaves in
  /// the object is there at the next try. False where the try at the world is rejected.
  bool place(SceneBuilder& builder, World& world,
             const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const {
    return place(
        builder, world, [](int, WorldObject&) {}, draw);
  }
  /// `begin` settles what is kept over the tries of object i, from 0.
  bool place(SceneBuilder& builder, World& world, const std::function<void(int i, WorldObject& object)>& begin,
             const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const;
};

}  // namespace moma
