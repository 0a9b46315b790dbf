#include "apps/common/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/common/defaults.h"
#include "apps/common/exit_code.h"
#include "apps/common/run_facts.h"
#include "apps/common/usage.h"
#include "core/version.h"

namespace flextip {
namespace {

/// Takes off what is behind "--" of flextip batch: options of another command.
std::vector<std::string> TakeOptionsOfItems(std::vector<std::string>& arguments) {
  const auto dashes = std::find(arguments.begin(), arguments.end(), "--");
  auto command = arguments.begin();
  while (command != dashes && command->starts_with("-")) {
    command += *command == "--defaults" && command + 1 != dashes ? 2 : 1;
  }
  if (dashes == arguments.end() || command == dashes || *command != "batch") return {};
  std::vector<std::string> behind(dashes + 1, arguments.end());
  arguments.erase(dashes, arguments.end());
  return behind;
}

int Run(const ProgramText& text, void (*add_commands)(CLI::App&, AppContext&),
        const std::vector<std::string>& typed) {
  AppContext context;
  context.program = [&](const auto& others) { return RunProgram(text, add_commands, others); };
  NoteTyped(text.name, typed);
  CLI::App app(text.description, text.name);
  app.set_version_flag("--version", fmt::format("{} {}", text.name, kVersion));
  app.add_flag("-q,--quiet", context.quiet, "No progress bar and no remarks, only errors");
  AddDefaults(app, context);
  app.footer(text.footer);
  app.require_subcommand(1);
  app.fallthrough();
  add_commands(app, context);
  try {
    std::vector<std::string> arguments = typed;
    context.behind_dashes = TakeOptionsOfItems(arguments);
    arguments = WithHelpAndVersion(std::move(arguments));
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(std::move(arguments));
  } catch (const CLI::Success& done) {  // --help, --version
    return app.exit(done);
  } catch (const CLI::ParseError& e) {
    return Complain(UsageMessage(app, e), kBadUsage);
  }
  context.work();
  return kDone;
}

}  // namespace

int RunProgram(const ProgramText& text, void (*add_commands)(CLI::App&, AppContext&),
               const std::vector<std::string>& typed) {
  return ExitCodeOf([&] { return Run(text, add_commands, typed); });
}

}  // namespace flextip
