// Checks that stay on in release builds. `assert` is for hot inner loops only.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace flextip {

/// Writes the failed condition, the message, file and line to stderr and aborts.
[[noreturn]] inline void CheckFailed(const char* condition, const char* message, const char* file,
                                     int line) {
  std::fprintf(stderr, "flextip: check failed: %s (%s) at %s:%d\n", message, condition, file, line);
  std::abort();
}

}  // namespace flextip

/// Aborts where `condition` does not hold: a programmer's bug, never bad input. For indices and
/// sizes that guard memory, and for invariants. `message` is a literal that says what must hold.
#define FLEXTIP_CHECK(condition, message) \
  ((condition) ? static_cast<void>(0)     \
               : ::flextip::CheckFailed(#condition, message, __FILE__, __LINE__))
