#include "apps/common/defaults.h"

namespace flextip {

void AddDefaults(CLI::App& app, AppContext& context) {
  // CLI11 reads the file; its name is kept for commands that must tell typed from default.
  auto* option = app.set_config("--defaults", "", "Options of every day, by command (TOML)");
  option->envname("FLEXTIP_DEFAULTS")->type_name("FILE");
  option->each([&context](const std::string& file) { context.defaults = file; });
  app.allow_config_extras(CLI::config_extras_mode::error);
}

}  // namespace flextip
