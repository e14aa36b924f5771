#include "world/scenario/family.h"

#include <array>

namespace moma {

std::span<const FamilyType> family_types() {
  static constexpr std::array<FamilyType, 8> kTypes{{
      {"open", read_open},
      {"clutter", read_clutter},
      {"table", read_table},
      {"shelf", read_shelf},
      {"doorway", read_doorway},
      {"corridor", read_corridor},
      {"moving", read_moving},
      {"tracking", read_tracking},
  }};
  return kTypes;
}

}  // namespace moma
