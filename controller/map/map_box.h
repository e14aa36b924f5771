#pragma once

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// A box that the controller's map gives the rest of the controller as an object (map/seen_map.h).
struct MapBox {
  int object = 0;  ///< index among the map's objects: first those of occupied space, then those of unseen space
  Vector3 p_W = Vector3::Zero();   ///< its middle
  Vector3 size = Vector3::Zero();  ///< edge lengths along the axes of the measured base pose [m]
};

/// Form in case files (`state.map`).
constexpr void describe(auto& v, Of<MapBox>) {
  using T = MapBox;
  v.member("object", &T::object, in_range({0, 1e6}, "", "index among the map's objects: occupied ones, then unseen"));
  v.member("position", &T::p_W, quantity("m", "of its middle"));
  v.member("size", &T::size, positive("m", "edge lengths"));
}

static_assert(is_complete<MapBox>());

}  // namespace moma
