// flextip completion: what shells and man read of the program's commands and options.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/common/commands.h"
#include "apps/common/manual.h"
#include "recording/text/text.h"

namespace flextip {

void AddCompletion(CLI::App& app, AppContext& context) {
  struct Options {
    std::filesystem::path man;
    std::string date;
  };
  auto* command = app.add_subcommand("completion", "Complete commands and options in the shell");
  auto options = std::make_shared<Options>();
  command->add_option("--man", options->man, "Write man pages into this folder instead")
      ->type_name("FOLDER");
  command->add_option("--date", options->date, "On the man pages")->type_name("DATE");
  command->footer(
      "Example (bash, and zsh after bashcompinit):\n"
      "  source <(flextip completion)\n"
      "  flextip completion --man man1\n");
  OnRun(*command, context, [options, &app] {
    if (options->man.empty()) {
      fmt::print("{}", CompletionScript(app));
      return;
    }
    for (const auto& [file, text] : ManPages(app, options->date)) {
      WriteTextFile(options->man / file, text);
    }
  });
}

}  // namespace flextip
