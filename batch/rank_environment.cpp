// What mpirun tells a process before MPI is begun.
#include <cstdlib>

#include "batch/ranks.h"

namespace flextip::batch {
namespace {

int Number(const char* first, const char* second, int otherwise) {
  for (const char* name : {first, second}) {
    const char* text = std::getenv(name);
    if (text && *text) return std::atoi(text);
  }
  return otherwise;
}

}  // namespace

bool IsRank() { return Number("OMPI_COMM_WORLD_RANK", "PMIX_RANK", -1) >= 0; }
int RankNumber() { return Number("OMPI_COMM_WORLD_RANK", "PMIX_RANK", 0); }
int RankCount() { return Number("OMPI_COMM_WORLD_SIZE", "SLURM_NTASKS", 1); }
int RanksOnThisMachine() {
  return Number("OMPI_COMM_WORLD_LOCAL_SIZE", "SLURM_NTASKS_PER_NODE", 1);
}

void LeaveRanks() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK"}) unsetenv(name);
}

}  // namespace flextip::batch
