#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "controller/describe/complete.h"
#include "controller/describe/keys.h"
#include "world/scenario/scene_builder.h"
#include "world/world.h"

namespace moma {

/// One family of worlds with its parameters: immutable, shared among threads.
class Family {
 public:
  virtual ~Family() = default;
  /// Returns all parameters, defaults included; the family's reader accepts the same keys.
  virtual Json to_json() const = 0;
  /// Tries to make a world once. False after builder.reject().
  virtual bool build(SceneBuilder& builder, World& world) const = 0;
};

struct FamilyType {
  std::string_view text;  ///< description of its worlds, one line for the reference
  /// Reads all its keys; the caller reads `weight` and calls finish().
  std::unique_ptr<const Family> (*read)(config::MapReader& in);
  std::vector<Key> (*keys)(const std::string& prefix);
  std::string_view name = "";
};

/// Returns every family, in the order of messages. families/NAME.cc defines
///   FamilyType NAME_family() { return family_type<T>("description of its worlds"); }
/// and the list of names in world/CMakeLists.txt generates the table.
std::span<const FamilyType> family_types();

namespace families {
/// Family::build() hides the function of T in its own scope; this function reaches it.
template <class T>
bool build_world(const T& parameters, SceneBuilder& builder, World& world) {
  return build(parameters, builder, world);
}
}  // namespace families

/// T is a described struct of parameters, with these functions beside it:
///   bool build(const T&, SceneBuilder&, World&)           implements Family::build()
///   void check(const T&, const config::MapReader&)        optional rule about several parameters: throws
template <Described T>
FamilyType family_type(std::string_view text) {
  static_assert(is_complete<T>(), "a parameter that is not described is in no file");
  class Model final : public Family {
   public:
    explicit Model(T parameters) : parameters_(std::move(parameters)) {}
    Json to_json() const override { return config::write_described(parameters_); }
    bool build(SceneBuilder& builder, World& world) const override {
      return families::build_world(parameters_, builder, world);
    }

   private:
    T parameters_;
  };
  return {.text = text,
          .read = [](config::MapReader& in) -> std::unique_ptr<const Family> {
            T parameters;
            config::read_members(in, parameters);
            if constexpr (requires { check(parameters, in); }) check(parameters, in);
            return std::make_unique<Model>(std::move(parameters));
          },
          .keys = [](const std::string& prefix) { return keys_of(T{}, prefix); }};
}

}  // namespace moma
