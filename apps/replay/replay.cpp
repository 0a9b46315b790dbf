// flextip replay: a recorded session or simulation run again, its commands compared bit for bit.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/common/commands.h"
#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/control/joint_session.h"
#include "core/error.h"
#include "diagnosis/model/extended_model.h"
#include "live/recorder/replay.h"
#include "recording/recording_reader.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/pages.h"
#include "simulation/closed_loop/excerpt.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct ReplayOptions {
  fs::path recording, session, out;
  bool force = false;
};

/// A command as it was and as it is now.
struct Pair {
  TimeNs t_ns = 0;
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero(), p_RW_again = Eigen::Vector3d::Zero();
  std::string hold, hold_again;
  bool equal = false;
};

struct Replayed {
  std::vector<Pair> pairs;
  std::vector<std::string> warnings;
  std::string of;  ///< "session", "simulation"
};

Replayed OfSession(const ReplayOptions& options) {
  const live::Session session = options.session.empty() ? live::RecordedSession(options.recording)
                                                        : live::ReadSession(options.session);
  const live::ReplayedSession run = live::ReplaySession(options.recording, session);
  Replayed replayed{{}, run.warnings, "session"};
  for (const live::ReplayedCycle& cycle : run.cycles) {
    if (!cycle.has_command && cycle.equal) continue;
    replayed.pairs.push_back({cycle.t_ns, cycle.p_RW, cycle.p_RW_again, live::Name(cycle.hold),
                              live::Name(cycle.hold_again), cycle.equal});
  }
  return replayed;
}

nlohmann::json SummaryOf(const fs::path& recording) {
  // Of several controllers, the summary is one folder up.
  for (const fs::path& folder : {recording, fs::weakly_canonical(recording).parent_path()}) {
    const fs::path file = folder / "summary.json";
    if (fs::exists(file)) return nlohmann::json::parse(ReadTextFile(file), nullptr, false);
  }
  return {};
}

Replayed FromCommands(const std::vector<simulation::ReplayedCommand>& commands,
                      const std::vector<std::string>& warnings) {
  Replayed replayed{{}, warnings, "simulation"};
  for (const auto& command : commands) {
    replayed.pairs.push_back(
        {command.t_ns, command.p_RW, command.p_RW_again, "", "", command.equal});
  }
  return replayed;
}

/// The scenario of a recording of simulate: where the run found it, or as given.
Replayed OfSimulation(const ReplayOptions& options) {
  const nlohmann::json summary = SummaryOf(options.recording);
  const bool has_loop = simulation::HasLoop(options.recording);
  if (!summary.is_object() || (summary.value("command", "") != "simulate" && !has_loop)) {
    throw InputError::At(options.recording.string(), 0,
                         "is no recording of flextip control or flextip simulate");
  }
  const auto inputs = summary.value("inputs", std::vector<std::string>());
  const fs::path file = !options.session.empty() ? options.session
                        : inputs.empty()         ? fs::path()
                                                 : fs::path(inputs.front());
  if (!fs::exists(file)) {
    throw InputError::At(file.string(), 0,
                         "is not there any more, expected the scenario of the run: name its place "
                         "by --session SCENARIO.yaml");
  }
  simulation::Scenario scenario = simulation::ReadScenario(file);
  if (inputs.size() > 1) simulation::UseModel(diagnosis::ReadModel(inputs[1]), scenario);
  const bool rendered = summary.value("rendered", false);
  const ReadResult read = ReadRecording(options.recording, {.check_frames = false});
  if (!read.recording.command0)
    throw InputError::At(options.recording.string(), 0, "no command0, expected one to replay");
  const auto kind = ControllerKindNamed(read.recording.command0->comment);
  if (!kind) {
    throw InputError::At((options.recording / "command0/sensor.yaml").string(), 0,
                         fmt::format("comment: found '{}', expected a controller's name",
                                     read.recording.command0->comment));
  }
  if (has_loop) {
    return FromCommands(simulation::ReplayLoop(scenario, *kind, options.recording), read.warnings);
  }
  std::unique_ptr<FrameSource> frames;
  if (rendered) {
    const auto& cam0 = read.recording.cam0;
    if (!cam0 || cam0->filenames.empty()) {
      throw InputError::At(options.recording.string(), 0,
                           "the run was rendered and its pictures were not kept (--frames-of): "
                           "replay needs them");
    }
    frames = OpenRecordedFrames(options.recording, "cam0", *cam0);
  }
  return FromCommands(simulation::ReplayController(scenario, *kind, read.recording, frames.get()),
                      read.warnings);
}

void WriteTable(const fs::path& file, const std::vector<Pair>& pairs) {
  CsvWriter csv({"timestamp [ns]", "command_x [m]", "command_y [m]", "command_z [m]", "again_x [m]",
                 "again_y [m]", "again_z [m]", "difference [m]", "hold []", "hold_again []",
                 "equal []"});
  for (const Pair& pair : pairs) {
    csv.Add(pair.t_ns);
    for (int i = 0; i < 3; ++i) csv.Add(pair.p_RW[i]);
    for (int i = 0; i < 3; ++i) csv.Add(pair.p_RW_again[i]);
    csv.Add((pair.p_RW - pair.p_RW_again).norm());
    csv.Add(pair.hold).Add(pair.hold_again).Add(std::string(pair.equal ? "1" : "0"));
    csv.EndRow();
  }
  WriteTextFile(file, csv.text());
}

/// Both commands over time, from where they began, and their difference.
std::vector<report::Figure> Figures(const std::vector<Pair>& pairs) {
  report::Figure commands, difference;
  commands.name = "commands";
  commands.title = "Commands of the wrist, as recorded and again";
  commands.x_label = difference.x_label = "time (s)";
  commands.y_label = "from the first command (mm)";
  difference.name = "difference";
  difference.title = "Distance between both commands";
  difference.y_label = "distance (mm)";
  difference.traces.resize(1);
  for (int i = 0; i < 6; ++i) {
    report::FigureTrace trace;
    trace.name = fmt::format("{}{}", "xyz"[i % 3], i < 3 ? "" : ", again");
    trace.dashed = i >= 3;
    for (const Pair& pair : pairs) {
      trace.x.push_back(1e-9 * static_cast<double>(pair.t_ns - pairs.front().t_ns));
      const Eigen::Vector3d& p = i < 3 ? pair.p_RW : pair.p_RW_again;
      trace.y.push_back(1e3 * (p - pairs.front().p_RW)[i % 3]);
    }
    difference.traces[0].x = trace.x;
    commands.traces.push_back(std::move(trace));
  }
  for (const Pair& pair : pairs)
    difference.traces[0].y.push_back(1e3 * (pair.p_RW - pair.p_RW_again).norm());
  return {commands, difference};
}

/// Of a session of joints: numbers alone.
void ReplayJoints(const ReplayOptions& options, OutputFolder& output, bool quiet) {
  if (!options.session.empty())
    throw InputError("--session is for a session with a shaft, found one of joints");
  const JointReplay replay = ReplayJointCycles(options.recording);
  const long equal = replay.cycles - replay.differ;
  output.WriteSummary({{"of", "joints"}, {"cycles", replay.cycles}, {"equal_cycles", equal}});
  output.Commit();
  if (!quiet) fmt::print("{} of {} cycles are the same bit for bit.\n", equal, replay.cycles);
  if (replay.differ > 0)
    throw WorkError(fmt::format("{}: {} of {} cycles came out differently",
                                options.recording.string(), replay.differ, replay.cycles));
}

void RunReplay(const ReplayOptions& options, bool quiet) {
  std::vector<fs::path> inputs{options.recording};
  if (!options.session.empty()) inputs.push_back(options.session);
  OutputFolder output(options.out, "replay", {.force = options.force, .inputs = inputs});
  if (HasJointCycles(options.recording)) return ReplayJoints(options, output, quiet);
  const Replayed replayed =
      live::HasSession(options.recording) ? OfSession(options) : OfSimulation(options);
  output.Warn(replayed.warnings);
  long equal = 0;
  double largest_m = 0.0;
  for (const Pair& pair : replayed.pairs) {
    equal += pair.equal;
    largest_m = std::max(largest_m, (pair.p_RW - pair.p_RW_again).norm());
  }
  const auto count = static_cast<long>(replayed.pairs.size());
  if (count == 0) throw InputError::At(options.recording.string(), 0, "has no command to replay");
  const bool same = equal == count;
  Judgement judged;
  judged.grade = same ? Grade::kGood : Grade::kBeware;
  judged.says = fmt::format("{} of {} commands are the same bit for bit.", equal, count);
  if (!same)
    judged.reasons.push_back(fmt::format("commands differ by up to {:.4g} mm", 1e3 * largest_m));
  WriteTable(output.folder() / "table.csv", replayed.pairs);
  report::WriteFigures(output.folder() / "figures.json", Figures(replayed.pairs));
  output.WriteSummary({{"verdict", JudgementJson(judged)},
                       {"of", replayed.of},
                       {"cycles", count},
                       {"equal_cycles", equal},
                       {"largest_difference_m", largest_m}});
  report::WriteCompareReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  if (!quiet) fmt::print("{}\n", (options.out / "report.html").string());
  if (!same && options.session.empty())
    throw WorkError(fmt::format("{}: {} of {} commands came out differently",
                                options.recording.string(), count - equal, count));
}

}  // namespace

void AddReplay(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "replay", "Run a recorded session or simulation again and compare every command");
  auto options = std::make_shared<ReplayOptions>();
  command->add_option("recording", options->recording, "Recording of control or of simulate")
      ->required()
      ->type_name("RECORDING");
  command
      ->add_option("--session", options->session,
                   "Another session (or scenario) on the same inputs: both commands side by side")
      ->type_name("OTHER.yaml");
  command->add_option("-o,--output", options->out, "Folder for table and page")
      ->required()
      ->type_name("OUT");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "A rendered simulation needs its pictures.\n"
      "Examples:\n  flextip replay session -o replayed\n"
      "  flextip replay session --session slower.yaml -o slower\n");
  OnRun(*command, context, [options, &context] { RunReplay(*options, context.quiet); });
}

}  // namespace flextip
