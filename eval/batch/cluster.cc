// The parts of Cluster that need no MPI.
#include "eval/batch/cluster.h"

#include <charconv>
#include <cstdlib>
#include <cstring>

namespace moma {

int Cluster::launched() noexcept {
  // Open MPI and its relatives; MPICH and Slurm's PMI-2. SLURM_NTASKS is no evidence: a batch script has it, too.
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* text = std::getenv(name);
    if (text == nullptr) continue;
    int size = 0;
    const char* const end = text + std::strlen(text);
    if (std::from_chars(text, end, size).ptr == end && size > 1) return size;
  }
  return 1;
}

}  // namespace moma
