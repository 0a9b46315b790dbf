#include "batch/cores.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>

#include "batch/ranks.h"

namespace flextip::batch {

int CoresOfThisProcess() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return std::max(1, CPU_COUNT(&set));
}

int ThreadsOfAnItem(int jobs) {
  const int cores = CoresOfThisProcess();
  // A process bound to some of the cores has them for itself.
  const bool bound = cores < sysconf(_SC_NPROCESSORS_ONLN);
  return std::max(1, cores / (jobs * (bound ? 1 : std::max(1, RanksOnThisMachine()))));
}

}  // namespace flextip::batch
