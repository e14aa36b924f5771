#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "controller/config/reader.h"
#include "world/scenario/scene_builder.h"
#include "world/world.h"

namespace moma {

/// One family of worlds with its parameters: immutable, shared among threads.
class Family {
 public:
  virtual ~Family() = default;
  /// All parameters, defaults included; its reader takes the same keys.
  virtual nlohmann::ordered_json to_json() const = 0;
  /// One try at a world. False after builder.reject().
  virtual bool build(SceneBuilder& builder, World& world) const = 0;
};

struct FamilyType {
  std::string_view name;
  /// Reads all its keys; the caller reads `weight` and calls finish().
  std::unique_ptr<const Family> (*read)(config::MapReader& in);
};

/// Every family, in the order that messages list them: families/NAME.cc defines
///   std::unique_ptr<const Family> read_NAME(config::MapReader& in);
/// and the list in world/CMakeLists.txt makes the table.
std::span<const FamilyType> family_types();

}  // namespace moma
