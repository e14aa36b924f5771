#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace moma::config {

inline constexpr std::uintmax_t kMaxMeshBytes = 64U << 20U;
inline constexpr std::size_t kMaxMeshVertices = 2'000'000;

/// Why a mesh file must not be given to the library that reads meshes, or "": no plain file, too long, not of a kind
/// whose reader is known to stand what strangers may write, or of content on which that reader would run for minutes or
/// out of its stack. The library chooses its reader by the name's end alone for these kinds.
std::string mesh_fault(const std::filesystem::path& file);

/// Length of the unit that a mesh file without a fault is in [m]: what a .dae says, as RViz and Gazebo take it; else 1.
double mesh_unit(const std::filesystem::path& file);

}  // namespace moma::config
