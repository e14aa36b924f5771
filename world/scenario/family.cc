#include "world/scenario/family.h"

#include <array>

namespace moma {

std::span<const FamilyType> family_types() {
  static constexpr std::array<FamilyType, 3> kTypes{{
      {"open", read_open},
      {"clutter", read_clutter},
      {"moving", read_moving},
  }};
  return kTypes;
}

}  // namespace moma
