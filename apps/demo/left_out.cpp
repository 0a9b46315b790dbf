// In place of simulate/serve.cpp and simulate/diagnose.cpp where the program has neither live
// control nor the diagnosis.
#include "apps/simulate/diagnose.h"
#include "apps/simulate/serve.h"
#include "core/error.h"

namespace flextip {
namespace {

[[noreturn]] void Refuse(const char* option) {
  throw InputError(std::string(option) + ": not in this program; build flextip: scripts/build");
}

}  // namespace

CLI::Option* AddServeOptions(CLI::App& command, ServeCommand& options) {
  return command.add_option("--serve", options.port, "Not in this program: see flextip simulate")
      ->type_name("PORT");
}

void RunServe(const ServeCommand&, bool) { Refuse("--serve"); }

CLI::Option* AddDiagnosingOptions(CLI::App& command, DiagnosingCommand& options) {
  return command.add_flag("--diagnose", options.asked, "Not in this program: see flextip simulate");
}

void RunDiagnosing(const DiagnosingCommand&, bool) { Refuse("--diagnose"); }

}  // namespace flextip
