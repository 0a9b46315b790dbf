#include "simulation/closed_loop/excerpt.h"

#include <memory>

#include "core/error.h"
#include "recording/cut.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"
#include "simulation/closed_loop/loop_table.h"
#include "stops/open_excerpt.h"

namespace flextip::simulation {
namespace {

namespace fs = std::filesystem;

fs::path TableOf(const fs::path& recording) { return recording / "loop0" / "cycles.csv"; }
fs::path StateOf(const fs::path& recording) { return recording / "loop0" / "state.txt"; }

/// The controller before the recording's first cycle.
std::unique_ptr<InstrumentController> ControllerAtBegin(const LoopSetup& setup,
                                                        const fs::path& recording) {
  auto controller = std::make_unique<InstrumentController>(ControllerOptionsOf(setup),
                                                           setup.model ? setup.model() : nullptr);
  const fs::path file = StateOf(recording);
  if (!fs::exists(file)) return controller;
  StateText state{ReadTextFile(file)};
  try {
    controller->VisitState(state);
    state.Finish();
  } catch (const InputError& error) {
    throw InputError::At(file.string(), 0, error.what());
  }
  return controller;
}

LoopSetup SetupOf(const Scenario& scenario, ControllerKind kind) {
  LoopSetup setup = scenario.loop;
  setup.controller.kind = kind;
  return setup;
}

WatchedCycle Look(const LoopCycle& cycle) {
  const Supervision& found = cycle.supervision;
  const bool held = found.reaction >= Reaction::kHold;
  return {cycle.t_ns, held ? Name(found.stop) : "", found.reaction == Reaction::kFault, true};
}

Moment MomentOf(const LoopCycle& cycle, const ControllerCommand& command) {
  Moment moment;
  moment.t_ns = cycle.t_ns;
  moment.readings = cycle.sensors;
  moment.p_RE_wanted = cycle.p_RE_desired;
  if (cycle.status != ControlStatus::kNoTip && cycle.status != ControlStatus::kNoWrist)
    moment.p_RE_used = cycle.p_RE_used;
  moment.f_tip_N = command.estimate.model.f_tip_N;
  moment.p_RW_sent = cycle.p_RW_command;
  moment.cause = Look(cycle).cause;
  moment.supervision = cycle.supervision;
  return moment;
}

/// One excerpt while its cycles go by.
struct Open : OpenExcerpt {
  explicit Open(const OpenExcerpt& excerpt) : OpenExcerpt(excerpt) {}
  LoopTableWriter table;
  bool done = false;
};

class ExcerptWriter {
 public:
  ExcerptWriter(const Scenario& scenario, ControllerKind kind, const fs::path& recording,
                const fs::path& to, const std::vector<StopEvent>& found)
      : setup_(SetupOf(scenario, kind)),
        from_(recording),
        to_(to),
        streams_(ReadRecording(recording, {.check_frames = false}).recording),
        stops_(StopsFound(found)) {
    for (const OpenExcerpt& open : OpenExcerpts(found, stops_)) opens_.emplace_back(open);
  }

  StopsOfRun Write() {
    RunAgain();
    return stops_;
  }

 private:
  void RunAgain() {
    ReadLog log;
    LoopTableReader table(TableOf(from_), log);
    const auto controller = ControllerAtBegin(setup_, from_);
    while (const auto cycle = table.Next()) {
      if (start_ns_ == 0) start_ns_ = cycle->t_ns;
      for (Open& open : opens_)
        if (open.state.empty() && cycle->t_ns >= open.from_ns) Begin(*controller, open);
      const ControllerCommand command = controller->Step(InputsOf(*cycle));
      LoopCycle again = *cycle;
      TakeCommand(command, again);
      for (Open& open : opens_) {
        if (open.state.empty() || open.done) continue;
        if (cycle->t_ns > open.to_ns) {
          Finish(open);
          continue;
        }
        open.table.Add(*cycle);
        open.differ += !SameCommand(*cycle, again);
        open.moments.push_back(MomentOf(*cycle, command));
      }
    }
    for (Open& open : opens_)
      if (!open.state.empty() && !open.done) Finish(open);
  }

  static void Begin(InstrumentController& controller, Open& open) {
    StateText state;
    controller.VisitState(state);
    open.state = state.Text();
  }

  void Finish(Open& open) {
    open.done = true;
    const fs::path folder = to_ / stops_.kept[open.number].folder;
    fs::create_directories(folder);
    WriteTextFile(TableOf(folder), open.table.Text());
    WriteTextFile(StateOf(folder), open.state);
    WriteRecording(folder, Cut(streams_, open.from_ns, open.to_ns));
    const StoppedRun run{start_ns_, ControllerOptionsOf(setup_).estimator,
                         setup_.supervision.max_motion_angle_rad,
                         setup_.supervision.max_tip_force_N, setup_.model};
    CloseExcerpt(open, run, folder, "", "another program or scenario made the recording", stops_);
    open.moments.clear();
  }

  LoopSetup setup_;
  fs::path from_, to_;
  Recording streams_;
  StopsOfRun stops_;
  TimeNs start_ns_ = 0;
  std::vector<Open> opens_;
};

}  // namespace

bool HasLoop(const fs::path& recording) { return fs::exists(TableOf(recording)); }

std::vector<ReplayedCommand> ReplayLoop(const Scenario& scenario, ControllerKind kind,
                                        const fs::path& recording) {
  ReadLog log;
  LoopTableReader table(TableOf(recording), log);
  const auto controller = ControllerAtBegin(SetupOf(scenario, kind), recording);
  std::vector<ReplayedCommand> commands;
  while (const auto cycle = table.Next()) {
    LoopCycle again = *cycle;
    TakeCommand(controller->Step(InputsOf(*cycle)), again);
    commands.push_back(
        {cycle->t_ns, cycle->p_RW_command, again.p_RW_command, SameCommand(*cycle, again)});
  }
  return commands;
}

std::vector<StopEvent> FindStops(const fs::path& recording) {
  ReadLog log;
  LoopTableReader table(TableOf(recording), log);
  StopFinder finder;
  while (const auto cycle = table.Next()) finder.Add(Look(*cycle));
  return finder.Stops();
}

StopsOfRun WriteExcerpts(const Scenario& scenario, ControllerKind kind, const fs::path& recording,
                         const fs::path& to) {
  const std::vector<StopEvent> found = FindStops(recording);
  if (found.empty()) return {};
  return ExcerptWriter(scenario, kind, recording, to, found).Write();
}

}  // namespace flextip::simulation
