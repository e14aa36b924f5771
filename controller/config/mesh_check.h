#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace moma::config {

inline constexpr std::uintmax_t kMaxMeshBytes = 64U << 20U;
inline constexpr std::size_t kMaxMeshVertices = 2'000'000;

struct MeshCheck {
  /// Why the file must not be given to the library that reads meshes, or "": no plain file, too long, not of a kind
  /// whose reader is known to stand what strangers may write, or of content on which that reader would run for minutes
  /// or out of its stack.
  std::string fault;
  double unit = 1.0;  ///< length of the unit that the file is in [m]: what a .dae says, as RViz and Gazebo take it
};

/// The library chooses its reader by the name's end alone for the kinds that pass.
MeshCheck check_mesh(const std::filesystem::path& file);

}  // namespace moma::config
