// One faulted run beside its healthy twin.
#pragma once

#include <map>
#include <vector>

#include "bench/fault_campaign/draw.h"
#include "bench/fault_campaign/hazard.h"
#include "bench/fault_campaign/record.h"

namespace flextip::bench {

/// The run without fault and supervision that a faulted one is held against.
struct Twin {
  double duration_s = 0.0;
  HazardLimits limits;
  double deviation_m = 0.0;
};

/// Healthy twins, each run once.
class Twins {
 public:
  const Twin& Of(const Base& base);

 private:
  std::map<Base, Twin> twins_;
};

/// Returns the faulted run as the plant is to have it, without supervision, and sets the faults'
/// begins in `run`.
simulation::LoopSetup FaultedSetup(const Twin& twin, FaultRun& run);

/// Runs `run` under each kind and judges it. A person resumes a second after the last fault is
/// over.
std::vector<FaultRecord> RunFault(FaultRun run, const std::vector<SupervisionKind>& kinds,
                                  Twins& twins);

/// Fills in what the supervisor said and did: its findings, and whether the loop went on. Faults as
/// they were in `run`.
void SetFindings(const FaultRun& run, const simulation::LoopResult& result, FaultRecord& record);

/// The sensor that a cycle's supervision names, by vote or by stop.
std::vector<simulation::FaultStream> Named(const Supervision& supervision);

}  // namespace flextip::bench
