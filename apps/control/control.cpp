// flextip control: a robot steered by the streams of a session, recorded while it runs.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/common/commands.h"
#include "apps/common/output.h"
#include "apps/control/figures.h"
#include "apps/control/joint_session.h"
#include "apps/control/joints.h"
#include "apps/control/tables.h"
#include "apps/stops/stops.h"
#include "core/error.h"
#include "diagnosis/running/running_diagnosis.h"
#include "diagnosis/running/warnings_table.h"
#include "live/joints/joint_session.h"
#include "live/loop/control_loop.h"
#include "live/recorder/excerpt.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/pages.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr int kPagePort = 18080;

struct ControlCommandOptions {
  fs::path session, out, model;
  std::optional<double> duration_s, timing_s;
  std::optional<int> page_port;
  bool page = false, wait = false, force = false;
};

/// Returns the page where one is wanted, and says where it is.
std::unique_ptr<live::Page> OpenPage(const ControlCommandOptions& options,
                                     const live::Session& session, live::Recorder* recorder) {
  if (!options.page && !options.page_port) return nullptr;
  live::PageOptions page_options;
  page_options.port = options.page_port.value_or(kPagePort);
  page_options.can_command = !options.timing_s;
  if (recorder != nullptr) {
    page_options.said = [recorder](TimeNs t_ns, const std::string& what) {
      recorder->TakeEvent(t_ns, what);
    };
  }
  auto page = std::make_unique<live::Page>(session, page_options);
  fmt::print("page: {}\n", page->Address());
  std::fflush(stdout);
  return page;
}

/// The run is over and recorded: what goes wrong with its excerpts is a warning.
StopsOfRun CutStops(OutputFolder& output, bool quiet) {
  try {
    ReadLog log;
    const std::size_t found = live::FindStops(output.folder(), log).size();
    if (found > 0 && !quiet) {
      // Minutes of a long run take some seconds.
      fmt::print("{} {}: cutting out the last seconds\n", found, found == 1 ? "stop" : "stops");
      std::fflush(stdout);
    }
    return live::WriteExcerpts(output.folder(), output.folder());
  } catch (const std::exception& error) {
    output.Warn(fmt::format("no excerpts of stops: {}", error.what()));
    return {};
  }
}

/// Ctrl-C ends the loop, not the program.
void RunControl(const ControlCommandOptions& options, bool quiet) {
  if (!options.model.empty()) {
    if (options.out.empty()) throw InputError("-o RECORDING is missing, expected it with --model");
    return WriteJointCommands({options.session, options.model, options.out, options.force, quiet});
  }
  if (std::filesystem::is_directory(options.session)) {
    throw InputError::At(options.session.string(), 0,
                         "is a folder, expected a session; a recording of an arm's desired joints "
                         "needs --model MODEL.yaml, which flextip diagnose writes");
  }
  if (live::IsJointSession(options.session)) {
    if (options.page || options.page_port || options.timing_s)
      throw InputError("--page and --timing are for a session with a shaft, found one of joints");
    return ControlJoints(
        {options.session, options.out, options.duration_s, options.wait, options.force, quiet});
  }
  const live::Session session = live::ReadSession(options.session);
  if (options.out.empty() && !options.timing_s)
    throw InputError("-o RECORDING is missing, expected it without --timing");
  live::LoopOptions loop;
  loop.wait = options.wait;
  loop.only_timing = options.timing_s.has_value();
  loop.duration_s = options.timing_s ? options.timing_s : options.duration_s;
  if (options.out.empty()) {
    const auto page = OpenPage(options, session, nullptr);
    loop.page = page.get();
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
  auto page = OpenPage(options, session, &recorder);
  loop.page = page.get();
  const live::LoopReport report = live::RunLoop(session, loop, &recorder);
  page.reset();
  recorder.Finish();
  if (recorder.Dropped() > 0)
    output.Warn(fmt::format("{} samples and cycles were not recorded: the disk was too slow",
                            recorder.Dropped()));
  for (const Warning& warning : report.causes) output.Warn(diagnosis::Text(warning.cause));
  if (session.task.watch.running)
    WriteTextFile(output.folder() / "warnings.csv", diagnosis::WarningsCsv(report.causes));
  const StopsOfRun stops = loop.only_timing ? StopsOfRun() : CutStops(output, quiet);
  nlohmann::ordered_json summary = ReportJson(session, report, loop.only_timing);
  AddStopsJson(stops, summary);
  output.WriteSummary(summary);
  report::WriteFigures(output.folder() / "figures.json", TimeFigures(report));
  WriteExcerptPages(output.folder(), stops, {options.session});
  report::WriteControlReport(output.folder());
  output.Commit();
  if (quiet) return;
  if (loop.only_timing) {
    PrintTimes(report);
  } else {
    PrintRun(report);
    for (const Warning& warning : report.causes)
      fmt::print("warning: {}\n", diagnosis::Text(warning.cause));
    PrintStops(stops, options.out);
  }
  fmt::print("{}\n", (options.out / "report.html").string());
}

}  // namespace

void AddControl(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("control", "Steer a robot by the streams of a session");
  auto options = std::make_shared<ControlCommandOptions>();
  command
      ->add_option("session", options->session,
                   "Streams, robot, limits and path; with --model a recording whose "
                   "joints_command0 are an arm's desired joints")
      ->required()
      ->type_name("SESSION.yaml");
  command->add_option("-o,--output", options->out, "Folder of the recording, written while it runs")
      ->type_name("RECORDING");
  command
      ->add_option("--model", options->model,
                   "What flextip diagnose found at an arm's joints: no robot moves, and the "
                   "commands that bring its true joints to the desired ones are written")
      ->type_name("MODEL.yaml");
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
  command->add_flag("--page", options->page, "Show the run on a page of this machine");
  command
      ->add_option("--page-port", options->page_port,
                   fmt::format("Port of the page, which it asks for; {} unless told, 0: a free one",
                               kPagePort))
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Ctrl-C pauses the robot and ends.\n"
      "Examples:\n  flextip control session.yaml -o session\n"
      "  flextip control --page session.yaml -o session\n"
      "  flextip control session.yaml --timing 10\n"
      "  flextip control desired --model diagnosis/model.yaml -o commands\n");
  OnRun(*command, context, [options, &context] { RunControl(*options, context.quiet); });
}

}  // namespace flextip
