#include "bench/fault_campaign/run.h"

#include <algorithm>
#include <exception>

#include "simulation/sensors/sensors.h"

namespace flextip::bench {
namespace {

using simulation::Fault;
using simulation::FaultKind;
using simulation::FaultStream;
using simulation::LoopResult;
using simulation::LoopSetup;
using simulation::LoopUpdate;

constexpr double kResume_s = 1.0;  // after the last fault
constexpr double kAfter_s = 3.0;   // beyond the healthy run's time and the resume
/// The plant throws the tip within its ramp of 0.1 s. It stays there for some cycles before anyone
/// can have stopped.
constexpr double kThrown_s = 0.25;

double TimeOf(const LoopUpdate& update) {
  return 1e-9 * static_cast<double>(update.t_ns - simulation::kSimulationStart_ns);
}

bool Throws(const Fault& fault) {
  return fault.stream == FaultStream::kPlant || fault.kind == FaultKind::kEncoderSlip;
}

bool HasEnd(const Fault& fault) { return fault.kind != FaultKind::kEncoderSlip; }

double EndOf(const FaultRun& run) {
  double end_s = 0.0;
  for (const Fault& fault : run.faults)
    end_s = std::max(end_s, fault.start_s + (HasEnd(fault) ? fault.duration_s : 0.0));
  return end_s;
}

double StartOf(const FaultRun& run) {
  double start_s = run.faults.front().start_s;
  for (const Fault& fault : run.faults) start_s = std::min(start_s, fault.start_s);
  return start_s;
}

/// What comes throws the tip, and what goes again.
std::vector<TimeSpan> ThrownOf(const FaultRun& run) {
  std::vector<TimeSpan> thrown;
  for (const Fault& fault : run.faults) {
    if (!Throws(fault)) continue;
    const double end_s = fault.start_s + fault.duration_s;
    thrown.push_back({fault.start_s, fault.start_s + kThrown_s});
    if (HasEnd(fault)) thrown.push_back({end_s, end_s + kThrown_s});
  }
  return thrown;
}

bool SaysSomething(const Supervision& supervision) {
  return supervision.voted_out != 0 || supervision.reaction >= Reaction::kHold;
}

void Describe(const FaultRun& run, const Twin& twin, FaultRecord& record) {
  record.number = run.number;
  record.fault = run.FaultText();
  record.size = SizeName(run.size);
  record.move = Name(run.base.move);
  record.controller = flextip::Name(run.base.controller);
  record.suite = Name(run.base.suite);
  record.floor = run.base.fixture;
  record.coarse = twin.limits.coarse;
  record.pair = run.faults.size() > 1;
  record.start_s = StartOf(run);
  record.duration_s = run.faults.front().duration_s;
  record.amount = run.faults.front().size;
  record.healthy_deviation_m = twin.deviation_m;
}

void SetNamed(const FaultRun& run, const Supervision& supervision, FaultRecord& record) {
  const std::vector<FaultStream> named = Named(supervision);
  if (named.empty()) return;
  const bool right = std::any_of(run.faults.begin(), run.faults.end(), [&](const Fault& fault) {
    return std::find(named.begin(), named.end(), fault.stream) != named.end();
  });
  record.named = right ? "right" : "wrong";
}

void SetGoingOn(const LoopResult& result, bool ended, double from_s, FaultRecord& record) {
  bool held = false, resumed = false;
  for (const LoopUpdate& update : result.updates) {
    if (TimeOf(update) < from_s) continue;
    held |= update.supervision.reaction >= Reaction::kHold;
    resumed |= update.resumed;
  }
  const bool holds_last =
      !result.updates.empty() && result.updates.back().supervision.reaction >= Reaction::kHold;
  record.going_on = !held                  ? "unheld"
                    : holds_last || !ended ? "no"
                    : resumed              ? "after resume"
                                           : "by itself";
}

void Judge(const FaultRun& run, const Twin& twin, const LoopSetup& setup, const LoopResult& result,
           FaultRecord& record) {
  const Hazards hazards = JudgeHazards(TrueCyclesOf(result, setup.fixtures), twin.limits,
                                       record.start_s, ThrownOf(run));
  record.hazard = hazards.Text();
  record.deviation_m = hazards.deviation_m;
  record.hazard_deviation_m = hazards.hazard_deviation_m;
  const bool over = TimeOf(result.updates.back()) >= setup.max_s - 0.1;
  record.outcome = !result.lost_equilibrium.empty() ? "no equilibrium" : over ? "time over" : "end";
  SetFindings(run, result, record);
}

}  // namespace

const Twin& Twins::Of(const Base& base) {
  const auto [at, is_new] = twins_.try_emplace(base);
  if (!is_new) return at->second;
  Twin& twin = at->second;
  const LoopSetup setup = SetupOf(base);
  const LoopResult result = RunClosedLoop(setup, nullptr);
  const Extremes extremes = ExtremesOf(TrueCyclesOf(result, setup.fixtures));
  twin.duration_s = TimeOf(result.updates.back());
  twin.limits = HazardLimitsOf(LimitsOf(base.move), extremes);
  twin.deviation_m = extremes.deviation_m;
  return twin;
}

std::vector<FaultStream> Named(const Supervision& supervision) {
  std::vector<FaultStream> named;
  const auto out = [&](VotedSensor sensor, FaultStream stream) {
    if (IsOut(supervision, sensor)) named.push_back(stream);
  };
  out(VotedSensor::kTip, FaultStream::kTip);
  out(VotedSensor::kEm, FaultStream::kEm0);
  out(VotedSensor::kStrain, FaultStream::kStrain);
  out(VotedSensor::kLoad, FaultStream::kLoad);
  out(VotedSensor::kWristTurn, FaultStream::kWrist);
  switch (supervision.stop) {
    case Stop::kStaleTip:
    case Stop::kTipJump:
    case Stop::kTipDisagrees:
      named.push_back(FaultStream::kTip);
      break;
    case Stop::kStaleWrist:
      named.push_back(FaultStream::kWrist);
      break;
    case Stop::kWristNotFollowing:
      named.push_back(FaultStream::kWrist);
      named.push_back(FaultStream::kRobot);
      break;
    case Stop::kDeadline:
      named.push_back(FaultStream::kRobot);
      break;
    case Stop::kPortMoved:
    case Stop::kForce:
      named.push_back(FaultStream::kPlant);
      break;
    default:
      break;
  }
  return named;
}

void SetFindings(const FaultRun& run, const LoopResult& result, FaultRecord& record) {
  const double start_s = StartOf(run);
  int cycles = 0;
  for (const LoopUpdate& update : result.updates) {
    const double t_s = TimeOf(update);
    const bool says = SaysSomething(update.supervision);
    if (t_s < start_s) {
      record.false_stop |= says;
      continue;
    }
    ++cycles;
    if (!says) continue;
    record.detected = true;
    record.detection_cycles = cycles;
    record.detection_s = t_s - start_s;
    record.deviation_at_detection_m = update.deviation_m;
    const double last_s = run.faults.front().duration_s;
    record.fault_part_at_detection = std::min(1.0, record.detection_s / last_s);
    const bool stopped = update.supervision.stop != Stop::kNone;
    record.first_stop = stopped ? Name(update.supervision.stop) : "vote";
    record.reaction = Name(update.supervision.reaction);
    SetNamed(run, update.supervision, record);
    break;
  }
  SetGoingOn(result, record.outcome == "end", start_s, record);
}

LoopSetup FaultedSetup(const Twin& twin, FaultRun& run) {
  StartAt(twin.duration_s, run);
  LoopSetup setup = SetupOf(run.base);
  setup.faults = run.faults;
  setup.resume_s = EndOf(run) + kResume_s;
  setup.max_s = std::max(twin.duration_s, *setup.resume_s) + kAfter_s;
  setup.fault_seed = simulation::FaultSeed(run.base.seed, static_cast<std::size_t>(run.number));
  return setup;
}

std::vector<FaultRecord> RunFault(FaultRun run, const std::vector<SupervisionKind>& kinds,
                                  Twins& twins) {
  const Twin& twin = twins.Of(run.base);
  const LoopSetup setup = FaultedSetup(twin, run);
  std::vector<FaultRecord> records;
  for (const SupervisionKind kind : kinds) {
    FaultRecord& record = records.emplace_back();
    Describe(run, twin, record);
    record.kind = flextip::Name(kind);
    try {
      Judge(run, twin, setup,
            RunClosedLoop(Supervised(setup, run.base.move, twin.limits.deviation_m, kind), nullptr),
            record);
    } catch (const std::exception& error) {
      record.outcome = std::string("threw: ") + error.what();
    }
  }
  return records;
}

}  // namespace flextip::bench
