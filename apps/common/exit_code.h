// The exit codes of the programs, and the one line on stderr that goes with a failure.
#pragma once

#include <functional>
#include <string>

namespace flextip {

inline constexpr int kDone = 0;        ///< the work is done
inline constexpr int kWorkFailed = 1;  ///< the work failed
inline constexpr int kBadUsage = 2;    ///< wrong usage or unreadable input

/// Prints "flextip: MESSAGE" on stderr. Returns `code`.
int Complain(const std::string& message, int code);

/// Returns the exit code of `program`, or for an exception prints its message and returns
/// kBadUsage for an InputError, kWorkFailed for any other.
int ExitCodeOf(const std::function<int()>& program);

}  // namespace flextip
