// flextip: the program. Exit codes: 0 done, 1 the work failed, 2 wrong usage or unreadable input.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/defaults.h"
#include "apps/common/exit_code.h"
#include "apps/common/run_facts.h"
#include "apps/common/usage.h"
#include "core/version.h"

namespace flextip {
namespace {

void AddCommands(CLI::App& app, AppContext& context) {
  AddAlign(app, context);
  AddBatch(app, context);
  AddBoard(app, context);
  AddCalibrate(app, context);
  AddCheck(app, context);
  AddCollar(app, context);
  AddCompare(app, context);
  AddCompletion(app, context);
  AddControl(app, context);
  AddConvert(app, context);
  AddDetect(app, context);
  AddDiagnose(app, context);
  AddEstimate(app, context);
  AddExport(app, context);
  AddImport(app, context);
  AddMap(app, context);
  AddReplay(app, context);
  AddReport(app, context);
  AddReproduce(app, context);
  AddShape(app, context);
  AddSimulate(app, context);
  AddTrack(app, context);
}

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

int Run(const std::vector<std::string>& typed) {
  AppContext context;
  context.program = [](const auto& others) { return ExitCodeOf([&] { return Run(others); }); };
  NoteTyped("flextip", typed);
  CLI::App app("Control of thin, bending surgical instruments by sight", "flextip");
  app.set_version_flag("--version", std::string("flextip ") + kVersion);
  app.add_flag("-q,--quiet", context.quiet, "No progress bar and no remarks, only errors");
  AddDefaults(app, context);
  app.footer("Every command explains itself: flextip help COMMAND\n");
  app.require_subcommand(1);
  app.fallthrough();
  AddCommands(app, context);
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
}  // namespace flextip

int main(int argc, char** argv) {
  return flextip::ExitCodeOf([&] { return flextip::Run({argv + 1, argv + argc}); });
}
