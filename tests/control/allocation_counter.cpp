#include "allocation_counter.h"

#include <atomic>
#include <cstddef>

// g++ says __SANITIZE_ADDRESS__, clang by __has_feature.
#if defined(__SANITIZE_ADDRESS__)
#define FLEXTIP_HAS_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define FLEXTIP_HAS_ADDRESS_SANITIZER 1
#endif
#endif

namespace {
std::atomic<long> allocations{0};
}

namespace flextip {
long AllocationCount() { return allocations.load(); }
}  // namespace flextip

// glibc's malloc, counted: operator new and Eigen's aligned memory both end here. The address
// sanitizer brings its own malloc; there the count stays 0.
#if defined(__GLIBC__) && !defined(FLEXTIP_HAS_ADDRESS_SANITIZER)
extern "C" {
void* __libc_malloc(std::size_t size);  // NOLINT
void* malloc(std::size_t size) {        // NOLINT
  ++allocations;
  return __libc_malloc(size);
}
}
#endif
