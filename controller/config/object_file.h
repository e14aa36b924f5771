#pragma once

#include <span>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/config/reader.h"
#include "controller/model/proximity.h"

namespace moma::config {

/// Reads a shape among the keys of a map: its kind under `word` (one of the `allowed`, if any are given); `size` [m]
/// (sphere: radius, also without a list; box: full edge lengths; cylinder: radius, length; capsule: radius, length
/// without caps); of a convex one `vertices` ([[x, y, z], ...]) and `triangles` ([[i, j, k], ...], counter-clockwise
/// seen from outside), or the same numbers in one list; without `triangles` the hull of the vertices. Throws
/// ConfigError: unknown words, other counts, sizes not above 0 (a capsule's length may be 0), fewer than four vertices
/// or triangles, indices of none, vertices in one plane without triangles.
Shape read_shape(MapReader& in, std::span<const ShapeKind> allowed = {}, const char* word = "shape");
/// Adds the same keys.
void write_shape(const Shape& shape, Json& json);

/// Returns the objects that reset() tells a controller (docs/reference/process-protocol.md, "Reset"): a list of
/// {name, shape, size, vertices, triangles}; `kind` is the same as `shape`.
Json objects_to_json(std::span<const ObjectShape> objects);
/// The same back. Keys that say where an object is, or how it moves, are left alone: they are for the steps.
std::vector<ObjectShape> read_objects(const Node& list, const std::string& key);

}  // namespace moma::config
