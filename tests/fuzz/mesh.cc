// Mesh files: the first byte chooses the kind.
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "controller/config/mesh_hull.h"
#include "tests/fuzz/target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace moma;
  // assimp clears 16 MiB for each OBJ, which takes longer than all else: one of eight.
  static const std::array<const char*, 8> kEnds = {".stl", ".dae", ".obj", ".stl", ".dae", ".stl", ".dae", ".stl"};
  if (size == 0) return 0;
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("moma-fuzz-" + std::to_string(getpid()) + kEnds[data[0] % kEnds.size()]);
  std::ofstream(file, std::ios::binary) << fuzz::text_of(data + 1, size - 1);
  try {
    const config::MeshSolid solid = config::point_solid(config::read_mesh(file, Vector3::Ones()).vertices);
    if (!solid.X_MS.matrix().allFinite()) std::abort();
  } catch (const std::runtime_error&) {
  }
  std::filesystem::remove(file);
  return 0;
}
