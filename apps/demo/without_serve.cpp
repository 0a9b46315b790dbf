// In place of simulate/serve.cpp where the program has no live control.
#include "apps/simulate/serve.h"
#include "core/error.h"

namespace flextip {

CLI::Option* AddServeOptions(CLI::App& command, ServeCommand& options) {
  return command.add_option("--serve", options.port, "Not in this program: see flextip simulate")
      ->type_name("PORT");
}

void RunServe(const ServeCommand&, bool) {
  throw InputError("--serve: this program has no live control; build flextip: scripts/build");
}

}  // namespace flextip
