// flextip report: the page of a result folder, made again from its files.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/common/commands.h"
#include "report/pages.h"

namespace flextip {

void AddReport(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("report", "Make a result's page again from its files");
  auto folder = std::make_shared<std::filesystem::path>();
  command->add_option("folder", *folder, "Folder that a command wrote (-o)")
      ->required()
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  command->footer(
      "Writes FOLDER/report.html in place of the page that is there; no other file is changed.\n\n"
      "Example:\n  flextip report OUT\n");
  OnRun(*command, context, [folder, &context] {
    report::WriteReport(*folder);
    if (!context.quiet) fmt::print("{}\n", (*folder / "report.html").string());
  });
}

}  // namespace flextip
