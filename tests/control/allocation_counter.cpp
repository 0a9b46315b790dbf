#include "allocation_counter.h"

#include <atomic>
#include <cstddef>

// The address and thread sanitizers bring their own malloc. g++ says it by a macro, clang by
// __has_feature.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FLEXTIP_OTHER_MALLOC 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FLEXTIP_OTHER_MALLOC 1
#endif
#endif
#if defined(__GLIBC__) && !defined(FLEXTIP_OTHER_MALLOC)
#define FLEXTIP_COUNTS_ALLOCATIONS 1
#else
#define FLEXTIP_COUNTS_ALLOCATIONS 0
#endif

namespace {
std::atomic<long> allocations{0};
}

namespace flextip {
long AllocationCount() { return allocations.load(); }
bool CountsAllocations() { return FLEXTIP_COUNTS_ALLOCATIONS != 0; }
}  // namespace flextip

// glibc's malloc, counted: operator new and Eigen's aligned memory both end here.
#if FLEXTIP_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t size);  // NOLINT
void* malloc(std::size_t size) {        // NOLINT
  ++allocations;
  return __libc_malloc(size);
}
}
#endif
