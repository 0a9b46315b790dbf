#include "apps/common/exit_code.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "core/error.h"

namespace flextip {

int Complain(const std::string& message, int code) {
  fmt::print(stderr, "flextip: {}\n", message);
  return code;
}

int ExitCodeOf(const std::function<int()>& program) {
  try {
    return program();
  } catch (const InputError& e) {
    return Complain(e.what(), kBadUsage);
  } catch (const std::exception& e) {
    return Complain(e.what(), kWorkFailed);
  } catch (...) {
    return Complain("stopped by an error of unknown kind", kWorkFailed);
  }
}

}  // namespace flextip
