#include "apps/common/exit_code.h"

#include <fmt/format.h>

#include <cxxabi.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <typeinfo>

#include "core/error.h"

namespace flextip {
namespace {

std::string TypeName(const std::exception& error) {
  const char* name = typeid(error).name();
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> demangled(
      abi::__cxa_demangle(name, nullptr, nullptr, &status), std::free);
  return status == 0 ? demangled.get() : name;
}

}  // namespace

int Complain(const std::string& message, int code) {
  fmt::print(stderr, "flextip: {}\n", Printable(message));
  return code;
}

int ExitCodeOf(const std::function<int()>& program) {
  try {
    return program();
  } catch (const InputError& e) {
    return Complain(e.what(), kBadUsage);
  } catch (const WorkError& e) {
    return Complain(e.what(), kWorkFailed);
  } catch (const std::filesystem::filesystem_error& e) {
    return Complain(fmt::format("{}: {}", e.path1().string(), e.code().message()), kWorkFailed);
  } catch (const std::bad_alloc&) {
    return Complain("the memory is not enough for what the input asks for", kWorkFailed);
  } catch (const std::exception& e) {  // the words of other libraries help nobody
    return Complain(fmt::format("stopped by an error that was not foreseen ({}): please report it, "
                                "with the command and its input",
                                TypeName(e)),
                    kWorkFailed);
  } catch (...) {
    return Complain("stopped by an error of unknown kind", kWorkFailed);
  }
}

}  // namespace flextip
