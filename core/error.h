// Errors of three kinds: a programmer's bug asserts, bad input throws InputError, and an expected
// failure (no tag, singular, not converged) is a status in the result of the function concerned.
#pragma once

#include <fmt/format.h>

#include <cassert>
#include <stdexcept>
#include <string>

#include "core/printable.h"

namespace flextip {

/// Input that cannot be used: one line that names the file, the line where there is one, what was
/// found and what was expected. The program prints it and exits with 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& what) : std::runtime_error(Printable(what)) {}

  /// Returns an error "FILE:LINE: what" on one line; `line` 0 leaves the line out.
  static InputError At(const std::string& file, long line, const std::string& what) {
    return InputError(PrintableLine(line > 0 ? fmt::format("{}:{}: {}", file, line, what)
                                             : fmt::format("{}: {}", file, what)));
  }
};

/// Work that was started on good input and failed (a disk that fills up, a solver that gives up on
/// the whole job). The program prints it and exits with 1.
class WorkError : public std::runtime_error {
 public:
  explicit WorkError(const std::string& what) : std::runtime_error(Printable(what)) {}
};

}  // namespace flextip
