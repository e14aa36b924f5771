#include "world/scenario/place_objects.h"

#include <utility>

namespace moma {

bool ObjectPlacing::place(SceneBuilder& builder, World& world,
                          const std::function<void(int i, WorldObject& object)>& begin,
                          const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const {
  for (int i = 0; i < count; ++i) {
    WorldObject object;
    object.name = name + std::to_string(i + 1);
    begin(i, object);
    bool placed = false;
    for (int k = 0; k < tries && !placed; ++k) {
      placed = draw({k, 1 + static_cast<std::uint64_t>(i * tries + k)}, object);
      if (!placed) builder.drawn_again(drawn_again);
    }
    if (i == 0) builder.first_object(placed, tries);
    if (!placed) return builder.reject(out_of_tries);
    world.objects.push_back(std::move(object));
  }
  return true;
}

}  // namespace moma
