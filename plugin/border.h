#pragma once

#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "controller/describe/numbers.h"
#include "controller/step_described.h"
#include "plugin/moma_plugin.h"

// Conversions of both sides of the C interface.
namespace moma::plugin {

// The structs of C give names to the numbers that descriptions have (describe/numbers.h). After a change of what is
// sensed `MOMA_UPDATE_DOCS=1 ctest -R BorderDocumentation` (controller_test) writes them.
// A new list of an observation needs a pointer in moma_observation, and its place in count_numbers() and the host.
static_assert(number_lists<Observation>() == 2, "moma_observation has the lists q and qdot");
static_assert(offsetof(moma_observation, q) == sizeof(double) * fixed_numbers<Observation>());
static_assert(sizeof(moma_object_state) == sizeof(double) * fixed_numbers<ObjectState>());
static_assert(offsetof(moma_step_result, solve_seconds) - offsetof(moma_step_result, status) ==
              sizeof(double) * fixed_numbers<Details>());

/// Number of numbers of an observation.
constexpr std::size_t count_numbers(std::size_t joints, std::size_t velocities, std::size_t objects) noexcept {
  return fixed_numbers<Observation>() + joints + velocities + objects * fixed_numbers<ObjectState>();
}

/// Address of the numbers of Details in an answer, for memcpy().
inline unsigned char* details_of(moma_step_result& answer) noexcept {
  return reinterpret_cast<unsigned char*>(&answer) + offsetof(moma_step_result, status);
}

inline ObjectShape read_shape(const moma_object_shape& object) {
  ObjectShape out{object.name, {}};
  out.shape.kind = static_cast<ShapeKind>(object.kind);
  out.shape.size = Vector3(object.size[0], object.size[1], object.size[2]);
  if (object.num_vertices == 0) return out;
  auto hull = std::make_shared<ConvexHull>();
  for (std::size_t i = 0; i < object.num_vertices; ++i) hull->vertices.emplace_back(object.vertices + 3 * i);
  for (std::size_t i = 0; i < object.num_triangles; ++i) hull->triangles.emplace_back(object.triangles + 3 * i);
  out.shape.hull = std::move(hull);
  return out;
}

/// Runs `call` and returns the text of the exception that it throws, if any.
template <typename Call>
std::optional<std::string> thrown_by(Call call) {
  try {
    call();
    return {};
  } catch (const std::exception& e) {
    return e.what();
  } catch (...) {
    return "an exception of unknown type";
  }
}

/// Runs `body`. An exception does not cross the border of C: it becomes the result `failed` and a text in `error`.
template <typename Result, typename Body>
Result guarded(Result failed, char* error, std::size_t error_size, Body body) noexcept {
  Result result = failed;
  const auto thrown = thrown_by([&] { result = body(); });
  if (thrown && error != nullptr && error_size > 0) error[thrown->copy(error, error_size - 1)] = '\0';
  return thrown ? failed : result;
}

}  // namespace moma::plugin
