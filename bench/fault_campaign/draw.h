// The campaign's runs, drawn so that every fault, size, moment, move, controller and suite has its
// even share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/fault_campaign/base.h"
#include "simulation/faults/fault.h"

namespace flextip::bench {

inline constexpr int kSizes = 4;
const char* SizeName(int size);  ///< "subtle", "plain", "strong", "absurd"

/// A fault of a stream and its four sizes.
struct FaultChoice {
  simulation::FaultKind kind;
  simulation::FaultStream stream;
  double sizes[kSizes];
};
const std::vector<FaultChoice>& FaultChoices();
/// Returns whether the sensors of `suite` have the stream.
bool Has(Suite suite, simulation::FaultStream stream);

struct FaultRun {
  int number = 0;
  Base base;
  std::vector<simulation::Fault> faults;  ///< one or two
  int size = 0;                           ///< index of all of them
  double start_part = 0.0;                ///< of the healthy run's time: when they begin

  std::string FaultText() const;  ///< "offset tip", "offset tip + stuck em0"
};

/// Returns the run of that number. Faults' begins are set by their part once the healthy run is
/// known (StartAt).
FaultRun DrawRun(std::uint64_t first_seed, int number);

/// Sets the faults' begins. A second fault begins within half a second of the first.
void StartAt(double healthy_s, FaultRun& run);

}  // namespace flextip::bench
