// flextip simulate: a closed loop of plant, sensors, vision and controllers, written as recordings.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/next_step.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/simulate/arm.h"
#include "apps/simulate/deviation.h"
#include "apps/simulate/diagnose.h"
#include "apps/simulate/frame_files.h"
#include "apps/simulate/serve.h"
#include "apps/stops/stops.h"
#include "core/error.h"
#include "diagnosis/model/extended_model.h"
#include "diagnosis/running/running_diagnosis.h"
#include "diagnosis/running/warnings_table.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"
#include "recording/truth.h"
#include "report/pages.h"
#include "simulation/closed_loop/excerpt.h"
#include "simulation/closed_loop/given_streams.h"
#include "simulation/closed_loop/loop_table.h"
#include "simulation/closed_loop/scenario_run.h"
#include "simulation/joints/arm_scenario.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoController = "none";

struct SimulateOptions {
  fs::path scenario, model, out;
  std::vector<std::string> frames_of;  ///< controllers whose frames are kept; empty: of all
  bool render = false, force = false;
  ServeCommand serve;
  DiagnosingCommand diagnosing;
};

/// Progress of several runs at once.
class SharedProgress {
 public:
  SharedProgress(std::size_t runs, bool quiet)
      : progress_("simulate", kUnits * runs, quiet), done_(runs) {}
  void Update(std::size_t run, int done, int total) {
    const std::lock_guard<std::mutex> lock(mutex_);
    done_[run] = std::min<std::size_t>(kUnits, kUnits * static_cast<std::size_t>(done) / total);
    std::size_t sum = 0;
    for (const std::size_t units : done_) sum += units;
    progress_.Update(sum);
  }

 private:
  static constexpr std::size_t kUnits = 1000;
  std::mutex mutex_;
  Progress progress_;
  std::vector<std::size_t> done_;
};

/// A controller's run and what stopped it.
struct OneRun {
  simulation::LoopResult result;
  StopsOfRun stops;
};

nlohmann::json Figures(const simulation::LoopSetup& setup, const OneRun& run) {
  const simulation::LoopResult& result = run.result;
  nlohmann::json figures = {{"max_deviation_m", result.max_deviation_m},
                            {"rms_deviation_m", result.rms_deviation_m},
                            {"final_error_m", result.final_error_m},
                            {"updates", result.updates.size()},
                            {"control_statuses", result.control_statuses},
                            {"tip_statuses", result.tip_statuses},
                            {"steps_limited", result.steps_limited},
                            {"steps_damped", result.steps_damped},
                            {"gain", result.gain}};
  if (run.stops.found > 0) figures["stops_found"] = run.stops.found;
  if (!setup.fixtures.list.empty()) figures["fixture_statuses"] = result.fixture_statuses;
  if (!setup.path.directions.empty())
    figures["final_direction_error_rad"] = result.final_direction_error_rad;
  return figures;
}

/// One controller's run, written into `folder` as a recording; of rendered frames those that
/// `keep_frames` asks for. A supervised one, or one with faults, has every cycle's inputs beside.
OneRun RunOne(const simulation::Scenario& scenario, ControllerKind kind,
              const simulation::Laparoscope* laparoscope, bool keep_frames, const fs::path& folder,
              const std::vector<fs::path>& inputs, const std::function<void(int, int)>& progress) {
  fs::create_directories(folder);
  const simulation::LoopSetup& loop = scenario.loop;
  const bool supervised = loop.supervision.kind != SupervisionKind::kNone;
  const bool keeps_cycles = supervised || !loop.faults.empty();
  simulation::LoopTableWriter cycles;
  simulation::GivenStreams given(loop);
  simulation::Scenario noted = scenario;
  if (keeps_cycles) {
    noted.loop.note_cycle = [&](const simulation::LoopCycle& cycle) {
      cycles.Add(cycle);
      given.Add(cycle);
    };
  }
  std::optional<FrameFiles> frames;
  if (laparoscope != nullptr) frames.emplace(folder, keep_frames);
  OneRun run;
  simulation::LoopResult& result = run.result;
  result = simulation::RunController(
      noted, kind, laparoscope,
      [&frames](TimeNs t_ns, const Image& image) { frames->Add(t_ns, image); }, progress);
  if (frames) frames->Finish(result.recording);
  given.PutInto(result.recording);
  WriteRecording(folder, result.recording);
  WriteTruth(folder, result.truth);
  WriteDeviation(folder / "deviation.csv", result);
  if (scenario.loop.watch)
    WriteTextFile(folder / "warnings.csv", diagnosis::WarningsCsv(WarningsOf(result)));
  if (!keeps_cycles) return run;
  WriteTextFile(folder / "loop0" / "cycles.csv", cycles.Text());
  if (supervised) run.stops = simulation::WriteExcerpts(scenario, kind, folder, folder);
  WriteExcerptPages(folder, run.stops, inputs);
  return run;
}

/// Throws InputError where --frames-of names a controller that does not run.
void CheckFramesOf(const SimulateOptions& options, const simulation::Scenario& scenario) {
  std::vector<std::string> run;
  for (const ControllerKind kind : scenario.controllers) run.emplace_back(Name(kind));
  for (const std::string& name : options.frames_of) {
    if (name == kNoController || std::find(run.begin(), run.end(), name) != run.end()) continue;
    throw InputError(fmt::format("--frames-of: found {}, expected none, or of the scenario's {}",
                                 name, fmt::join(run, ", ")));
  }
}

/// Returns whether the frames of a controller are written.
bool KeepsFrames(const SimulateOptions& options, ControllerKind kind) {
  const auto& names = options.frames_of;
  return names.empty() || std::find(names.begin(), names.end(), Name(kind)) != names.end();
}

/// Hands over to --serve, or throws InputError where only it could do without an option.
bool Serves(const SimulateOptions& options, bool quiet) {
  if (options.serve.port) {
    ServeCommand serve = options.serve;
    serve.scenario = options.scenario;
    serve.out = options.out;
    serve.render = options.render;
    serve.force = options.force;
    RunServe(serve, quiet);
    return true;
  }
  if (options.out.empty()) throw InputError("--output is required, or --serve PORT");
  return false;
}

/// Hands over to --diagnose.
bool Diagnoses(const SimulateOptions& options, bool quiet) {
  if (!options.diagnosing.asked) return false;
  DiagnosingCommand diagnosing = options.diagnosing;
  diagnosing.scenario = options.scenario;
  diagnosing.out = options.out;
  diagnosing.force = options.force;
  RunDiagnosing(diagnosing, quiet);
  return true;
}

/// Runs a scenario of an arm with joints, which has no controllers.
bool SimulatesArm(const SimulateOptions& options, bool quiet) {
  if (!fs::exists(options.scenario) || !simulation::IsArmScenario(options.scenario)) return false;
  const bool of_a_shaft = options.render || options.serve.port || options.diagnosing.asked ||
                          !options.model.empty() || !options.frames_of.empty();
  if (of_a_shaft) {
    throw InputError::At(options.scenario.string(), 0,
                         "is of an arm with joints, which --render, --frames-of, --serve, "
                         "--diagnose and --model do not take");
  }
  if (options.out.empty()) throw InputError("--output is required");
  SimulateArm({options.scenario, options.out, options.force}, quiet);
  return true;
}

void RunSimulate(const SimulateOptions& options, bool quiet) {
  if (SimulatesArm(options, quiet)) return;
  if (Serves(options, quiet) || Diagnoses(options, quiet)) return;
  simulation::Scenario scenario = simulation::ReadScenario(options.scenario);
  simulation::RequireRunnable(scenario, options.scenario, options.render);
  CheckFramesOf(options, scenario);
  simulation::RequireShort(scenario, options.scenario);
  std::vector<fs::path> inputs = {options.scenario};
  if (!options.model.empty()) {
    inputs.push_back(options.model);
    simulation::UseModel(diagnosis::ReadModel(options.model), scenario);
  }
  OutputFolder output(options.out, "simulate", {.force = options.force, .inputs = inputs});
  output.Warn(scenario.warnings);
  std::optional<simulation::Laparoscope> laparoscope;
  if (options.render) laparoscope.emplace(simulation::LaparoscopeOf(scenario));
  const std::size_t runs = scenario.controllers.size();
  std::vector<OneRun> results(runs);
  {
    SharedProgress progress(runs, quiet);
    tbb::parallel_for(std::size_t(0), runs, [&](std::size_t i) {
      const ControllerKind kind = scenario.controllers[i];
      const fs::path folder = runs == 1 ? output.folder() : output.folder() / Name(kind);
      results[i] =
          RunOne(scenario, kind, laparoscope ? &*laparoscope : nullptr, KeepsFrames(options, kind),
                 folder, inputs, [&](int done, int total) { progress.Update(i, done, total); });
    });
  }
  nlohmann::json controllers;
  std::vector<std::string> causes;
  for (std::size_t i = 0; i < runs; ++i) {
    const auto& updates = results[i].result.updates;
    if (updates.empty() || !updates.back().cause.IsThere()) continue;
    const FoundCause& cause = updates.back().cause;
    causes.push_back(fmt::format("{}: {}", Name(scenario.controllers[i]), diagnosis::Text(cause)));
  }
  output.Warn(causes);
  for (std::size_t i = 0; i < runs; ++i)
    controllers[Name(scenario.controllers[i])] = Figures(scenario.loop, results[i]);
  nlohmann::ordered_json summary = {{"scenario", options.scenario.filename().string()},
                                    {"rendered", options.render},
                                    {"controllers", controllers}};
  if (runs == 1) AddStopsJson(results[0].stops, summary);
  if (!options.model.empty()) summary["model"] = options.model.filename().string();
  output.WriteSummary(summary);
  report::WriteSimulateReport(output.folder());
  output.Commit();
  if (quiet) return;
  fmt::print("{:<20} {:>12} {:>12}\n", "deviation (mm)", "max", "rms");
  for (std::size_t i = 0; i < runs; ++i) {
    fmt::print("{:<20} {:>12.3f} {:>12.3f}\n", Name(scenario.controllers[i]),
               1e3 * results[i].result.max_deviation_m, 1e3 * results[i].result.rms_deviation_m);
  }
  for (std::size_t i = 0; i < runs; ++i) {
    const char* kind = Name(scenario.controllers[i]);
    if (runs > 1 && results[i].stops.found > 0) fmt::print("{}:\n", kind);
    PrintStops(results[i].stops, runs == 1 ? options.out : options.out / kind);
  }
  for (const std::string& cause : causes) fmt::print("warning: {}\n", cause);
  PrintNextOf(output.folder());
  fmt::print("report: {}\n", (options.out / "report.html").string());
}

}  // namespace

void AddSimulate(CLI::App& app, AppContext& context) {
  auto* command =
      app.add_subcommand("simulate", "Run a closed loop and write it as recordings with truth");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("scenario", options->scenario, "What to run")
      ->required()
      ->type_name("SCENARIO.yaml");
  command->add_option("-o,--output", options->out, "Folder for the recording")
      ->type_name("RECORDING");
  auto* model =
      command
          ->add_option("--model", options->model,
                       "Estimator and controllers know of the effects in this model.yaml (the "
                       "simulated instrument does not: its own are in the scenario)")
          ->type_name("MODEL.yaml");
  auto* render =
      command->add_flag("--render", options->render,
                        "Render laparoscope frames and run the loop on what vision sees in them");
  auto* frames_of =
      command
          ->add_option(
              "--frames-of", options->frames_of,
              "Write the frames of these controllers alone (none: of no controller); without "
              "it of all, some 1 MB each")
          ->needs(render)
          ->delimiter(',')
          ->type_name("CONTROLLER");
  auto* serve = AddServeOptions(*command, options->serve);
  serve->excludes(model)->excludes(frames_of);
  AddDiagnosingOptions(*command, options->diagnosing)
      ->excludes(serve)
      ->excludes(model)
      ->excludes(render);
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "With several controllers each gets a folder of its name, a recording of its own.\n"
      "Examples:\n  flextip simulate testdata/scenarios/press.yaml --render -o press\n"
      "the same, with the frames of one controller of six\n"
      "  flextip simulate testdata/scenarios/press.yaml --render --frames-of rod-track -o press\n"
      "a robot that is not there, for flextip control and other clients\n"
      "  flextip simulate testdata/scenarios/press.yaml --serve 18944\n"
      "an arm with joints\n"
      "  flextip simulate testdata/scenarios/arm.yaml -o arm\n"
      "a robot that moves until it knows what is wrong with its instrument\n"
      "  flextip simulate testdata/scenarios/tag_or_camera.yaml --diagnose -o found\n");
  OnRun(*command, context, [options, &context] { RunSimulate(*options, context.quiet); });
}

}  // namespace flextip
