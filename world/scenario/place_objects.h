#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "world/scenario/scene_builder.h"

namespace moma {

struct ObjectTry {
  int number = 0;          ///< number of tries for this object before
  std::uint64_t item = 1;  ///< the object's item for SceneBuilder::draws(); 0 is for draws that all objects share
};

struct ObjectPlacing {
  int count = 0;             ///< number of objects
  int tries = 1;             ///< number of tries for each
  std::string name;          ///< objects are called NAME1, NAME2 ... by default
  std::string drawn_again;   ///< reason counted if an object is drawn again
  std::string out_of_tries;  ///< reason counted if an object finds no place

  /// Adds the objects to the world one after another. `draw` draws one and returns whether it may stay; the next try
  /// starts with the object as `draw` left it. False if the try at the world is rejected.
  bool place(SceneBuilder& builder, World& world,
             const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const {
    return place(
        builder, world, [](int, WorldObject&) {}, draw);
  }
  /// `begin` sets the properties that object i, from 0, keeps over its tries.
  bool place(SceneBuilder& builder, World& world, const std::function<void(int i, WorldObject& object)>& begin,
             const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const;
};

}  // namespace moma
