// The commands of the program and what they share. A command is one file, apps/<name>.cpp, that
// reads its options, composes the libraries and writes its results; main.cpp adds it.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace flextip {

/// What every command is given. It outlives the parsing and the work.
struct AppContext {
  bool quiet = false;              ///< no progress and no chatter; errors still go to stderr
  std::filesystem::path defaults;  ///< a file with values of options; empty: none was given
  std::function<void()> work;      ///< set by the command that was chosen, run after parsing
  std::vector<std::string> behind_dashes;  ///< of flextip batch: options of the command it runs
  /// The program itself, on arguments (without its name) as a user types them. Returns the exit
  /// code.
  std::function<int(const std::vector<std::string>& arguments)> program;
};

/// Makes `work` what the program does when `command` is chosen. It returns on success, throws
/// InputError (exit 2) for input it cannot use and WorkError (exit 1) where the work failed.
inline void OnRun(CLI::App& command, AppContext& context, std::function<void()> work) {
  command.callback([&context, work = std::move(work)] { context.work = work; });
}

// Each adds one subcommand to `app`, with its options and an example in its footer:
//   CLI::App& command = *app.add_subcommand("track", "Localise tags and the tip in frames");
//   auto options = std::make_shared<TrackOptions>();
//   command.add_option(...);
//   command.footer("Example:\n  flextip track RECORDING -o OUT");
//   OnRun(command, context, [options, &context] { RunTrack(*options, context); });
void AddAlign(CLI::App& app, AppContext& context);
void AddBatch(CLI::App& app, AppContext& context);
void AddBoard(CLI::App& app, AppContext& context);
void AddCalibrate(CLI::App& app, AppContext& context);
void AddCheck(CLI::App& app, AppContext& context);
void AddCollar(CLI::App& app, AppContext& context);
void AddCompare(CLI::App& app, AppContext& context);
void AddControl(CLI::App& app, AppContext& context);
void AddDiagnose(CLI::App& app, AppContext& context);
void AddCompletion(CLI::App& app, AppContext& context);
void AddConvert(CLI::App& app, AppContext& context);
void AddDetect(CLI::App& app, AppContext& context);
void AddEffect(CLI::App& app, AppContext& context);
void AddEstimate(CLI::App& app, AppContext& context);
void AddExport(CLI::App& app, AppContext& context);
void AddImport(CLI::App& app, AppContext& context);
void AddMap(CLI::App& app, AppContext& context);
void AddPredict(CLI::App& app, AppContext& context);
void AddReplay(CLI::App& app, AppContext& context);
void AddReport(CLI::App& app, AppContext& context);
void AddReproduce(CLI::App& app, AppContext& context);
void AddShape(CLI::App& app, AppContext& context);
void AddSimulate(CLI::App& app, AppContext& context);
void AddTrack(CLI::App& app, AppContext& context);

}  // namespace flextip
