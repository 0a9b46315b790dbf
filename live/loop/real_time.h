// Conditions under which a thread keeps its times: priority and memory that stays in place.
#pragma once

#include <sched.h>

namespace flextip::live {

/// Real-time priority for the calling thread, and all memory of the process kept from being swapped
/// or mapped late, while the object lives; each where the system gives it. Memory is locked only
/// where no limit could make later allocations fail. From then on the process keeps what it frees,
/// up to 256 MB.
class RealTime {
 public:
  RealTime();
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  bool HasPriority() const { return has_priority_; }
  bool HasLockedMemory() const { return has_locked_memory_; }

 private:
  int policy_ = 0;
  sched_param before_{};
  bool has_priority_ = false, has_locked_memory_ = false;
};

}  // namespace flextip::live
