#include "live/loop/real_time.h"

#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace flextip::live {
namespace {

constexpr int kPriority = 10;  // the least but nine
// Pictures come and go: what they took is kept, or every page of each would be mapped anew.
constexpr int kKept_bytes = 256 << 20, kMapped_bytes = 32 << 20;

bool MayLockAll() {
  rlimit limit{};
  const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
  return unlimited || geteuid() == 0;
}

}  // namespace

RealTime::RealTime() {
  pthread_getschedparam(pthread_self(), &policy_, &before_);
  sched_param wanted{};
  wanted.sched_priority = kPriority;
  has_priority_ = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) == 0;
  mallopt(M_TRIM_THRESHOLD, kKept_bytes);
  mallopt(M_MMAP_THRESHOLD, kMapped_bytes);
  has_locked_memory_ = MayLockAll() && mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
}

RealTime::~RealTime() {
  if (has_locked_memory_) munlockall();
  if (has_priority_) pthread_setschedparam(pthread_self(), policy_, &before_);
}

}  // namespace flextip::live
