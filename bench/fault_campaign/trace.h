// A run cycle by cycle, for a look at it.
#pragma once

#include <string>
#include <vector>

#include "bench/fault_campaign/run.h"

namespace flextip::bench {

struct Trace {
  FaultRun run;
  SupervisionKind kind = SupervisionKind::kFull;
  HazardLimits limits;
  simulation::LoopResult result;
};

Trace TraceRun(FaultRun run, SupervisionKind kind, Twins& twins);

/// The same of a healthy run, which has no fault.
Trace TraceHealthyRun(std::uint64_t first_seed, int number, SupervisionKind kind);

/// Returns a row a cycle: the truth, what was seen and commanded, what the supervisor found.
std::string TraceCsv(const Trace& trace);

/// Returns a picture of each run: how far the tip is off its path over time, the fault's time
/// shaded, and below it what the supervisor did.
std::string TracesSvg(const std::vector<Trace>& traces);

}  // namespace flextip::bench
