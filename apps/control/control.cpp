// flextip control: a robot steered by the streams of a session, recorded while it runs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "apps/common/commands.h"
#include "apps/common/output.h"
#include "apps/control/tables.h"
#include "core/error.h"
#include "live/loop/control_loop.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct ControlCommandOptions {
  fs::path session, out;
  std::optional<double> duration_s, timing_s;
  bool wait = false, force = false;
};

/// Ctrl-C ends the loop, not the program.
void RunControl(const ControlCommandOptions& options, bool quiet) {
  const live::Session session = live::ReadSession(options.session);
  if (options.out.empty() && !options.timing_s)
    throw InputError("-o RECORDING is missing, expected it without --timing");
  live::LoopOptions loop;
  loop.wait = options.wait;
  loop.only_timing = options.timing_s.has_value();
  loop.duration_s = options.timing_s ? options.timing_s : options.duration_s;
  if (options.out.empty()) {
    const live::LoopReport report = live::RunLoop(session, loop, nullptr);
    PrintTimes(report);
    return;
  }
  OutputFolder output(options.out, "control",
                      {.force = options.force, .inputs = {options.session}, .in_place = true});
  output.OnlyNoteInterrupt();
  output.Warn(session.warnings);
  loop.stop = [&output] { return output.StopRequested(); };
  live::Recorder recorder(output.folder(), session, options.wait || loop.only_timing);
  const live::LoopReport report = live::RunLoop(session, loop, &recorder);
  recorder.Finish();
  if (recorder.Dropped() > 0)
    output.Warn(fmt::format("{} samples and cycles were not recorded: the disk was too slow",
                            recorder.Dropped()));
  output.WriteSummary(ReportJson(session, report));
  output.Commit();
  if (quiet) return;
  if (loop.only_timing) {
    PrintTimes(report);
  } else {
    PrintRun(report);
  }
}

}  // namespace

void AddControl(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("control", "Steer a robot by the streams of a session");
  auto options = std::make_shared<ControlCommandOptions>();
  command->add_option("session", options->session, "Streams, robot, limits and path")
      ->required()
      ->type_name("SESSION.yaml");
  command->add_option("-o,--output", options->out, "Folder of the recording, written while it runs")
      ->type_name("RECORDING");
  command->add_flag("--wait", options->wait,
                    "Wait until somebody else has homed and enabled the robot");
  command->add_option("--duration", options->duration_s, "End after so many seconds at the latest")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command
      ->add_option("--timing", options->timing_s,
                   "Only measure for so many seconds how fast and how evenly the cycle runs; the "
                   "robot is not enabled")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Ctrl-C pauses the robot and ends.\n"
      "Examples:\n  flextip control session.yaml -o session\n"
      "  flextip control session.yaml --timing 10\n");
  OnRun(*command, context, [options, &context] { RunControl(*options, context.quiet); });
}

}  // namespace flextip
