#pragma once

#include <stdlib.h>
#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace moma::test {

/// Open MPI's mpirun; nullptr where there is none.
inline const char* find_mpirun() {
  for (const char* file : {"/usr/bin/mpirun", "/usr/local/bin/mpirun"})
    if (std::filesystem::exists(file)) return file;
  return nullptr;
}

/// For the mpirun of tests: on one machine of any number of cores, also as root.
inline void prepare_mpirun() {
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
  setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
}

/// A process of this rank that works in `folder`; 0 where there is none.
inline pid_t find_rank(const std::filesystem::path& folder, const std::string& rank) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::error_code error;
    if (std::filesystem::read_symlink(entry.path() / "cwd", error) != folder || error) continue;
    if (std::filesystem::read_symlink(entry.path() / "exe", error).filename() != "moma" || error) continue;
    std::ifstream stream(entry.path() / "environ", std::ios::binary);
    const std::string environment{std::istreambuf_iterator<char>(stream), {}};
    if (environment.find("OMPI_COMM_WORLD_RANK=" + rank + '\0') != std::string::npos) return std::stoi(name);
  }
  return 0;
}

}  // namespace moma::test
