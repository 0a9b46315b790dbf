#include "simulation/faults/sensor_faults.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "simulation/sensors/sensors.h"

namespace flextip::simulation {
namespace {

void Check(const Fault& fault) {
  if (!CanHave(fault.stream, fault.kind)) {
    throw InputError(
        fmt::format("there is no fault {} of {}", Name(fault.kind), Name(fault.stream)));
  }
  if (std::isfinite(fault.start_s + fault.duration_s + fault.size)) return;
  throw InputError(fmt::format("fault {} of {}: found {} s, {} s and {}, expected finite numbers",
                               Name(fault.kind), Name(fault.stream), fault.start_s,
                               fault.duration_s, fault.size));
}

template <class M>
void DisturbAll(std::vector<SampleFault<M>>& faults, double t_s, std::optional<Sample<M>>& sample) {
  for (SampleFault<M>& fault : faults) fault.Disturb(t_s, sample);
}

}  // namespace

SensorFaults::SensorFaults(const std::vector<Fault>& faults, std::uint64_t seed) {
  for (std::size_t i = 0; i < faults.size(); ++i) {
    Check(faults[i]);
    const std::uint64_t own = FaultSeed(seed, i);
    if (faults[i].stream == FaultStream::kWrist) wrist_.emplace_back(faults[i], own);
    if (faults[i].stream == FaultStream::kTip) tip_.emplace_back(faults[i], own);
    if (faults[i].stream == FaultStream::kEm0) em0_.emplace_back(faults[i], own);
    if (faults[i].stream == FaultStream::kStrain) strain_.emplace_back(faults[i], own);
    if (faults[i].stream == FaultStream::kLoad) load_.emplace_back(faults[i], own);
  }
}

void SensorFaults::Disturb(TimeNs t_ns, SensorReadings& readings) {
  const double t_s = 1e-9 * static_cast<double>(t_ns - kSimulationStart_ns);
  DisturbAll(wrist_, t_s, readings.wrist);
  DisturbAll(tip_, t_s, readings.tip);
  DisturbAll(em0_, t_s, readings.em0);
  DisturbAll(strain_, t_s, readings.strain);
  DisturbAll(load_, t_s, readings.load);
}

}  // namespace flextip::simulation
