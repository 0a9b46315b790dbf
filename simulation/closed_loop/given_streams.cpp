#include "simulation/closed_loop/given_streams.h"

#include <algorithm>
#include <cmath>

namespace flextip::simulation {
namespace {

template <class T>
void AddNewer(const std::optional<Sample<T>>& sample, TimeNs later_ns, Series<T>& series) {
  if (!sample) return;
  const TimeNs t_ns = sample->t_ns + later_ns;
  if (series.empty() || t_ns > series.back().t_ns) series.push_back({t_ns, sample->value});
}

/// Replaces the samples of a stream by those that `make` makes; a stream without any is kept.
template <class Value, class T, class Make>
void Replace(const Series<T>& given, Series<Value>& samples, Make make) {
  if (given.empty()) return;
  samples.clear();
  for (const Sample<T>& sample : given)
    if (auto value = make(sample.value)) samples.push_back({sample.t_ns, *value});
}

TimeNs Ns(double seconds) { return std::llround(1e9 * seconds); }

}  // namespace

bool GivenStreams::HasFault(FaultStream stream) const {
  return std::any_of(setup_.faults.begin(), setup_.faults.end(),
                     [&](const Fault& fault) { return fault.stream == stream; });
}

void GivenStreams::Add(const LoopCycle& cycle) {
  const SensorReadings& given = cycle.sensors;
  if (HasFault(FaultStream::kWrist)) AddNewer(given.wrist, 0, wrist_);
  if (HasFault(FaultStream::kTip)) AddNewer(given.tip, Ns(setup_.tip_latency.value_s), tip_);
  if (HasFault(FaultStream::kEm0)) AddNewer(given.em0, Ns(setup_.em0_latency.value_s), em0_);
  if (HasFault(FaultStream::kStrain)) AddNewer(given.strain, 0, strain_);
  if (HasFault(FaultStream::kLoad)) AddNewer(given.load, 0, load_);
}

void GivenStreams::PutInto(Recording& recording) const {
  if (recording.wrist0) {
    Replace(wrist_, recording.wrist0->samples,
            [](const WristMeasurement& z) -> std::optional<WristSample> {
              if (!z.p_RW.allFinite()) return {};
              WristSample sample{z.p_RW, {}};
              if (z.R_RW) sample.q_RW = Eigen::Quaterniond(*z.R_RW).normalized();
              return sample;
            });
  }
  if (recording.vision0) {
    Replace(tip_, recording.vision0->tips,
            [](const TipMeasurement& z) -> std::optional<TipObservation> {
              if (z.tip.status != TipStatus::kLost && !z.tip.p_RE.allFinite()) return {};
              return z.tip;
            });
  }
  if (recording.em0) {
    Replace(em0_, recording.em0->samples, [](const EmMeasurement& z) -> std::optional<EmSample> {
      if (!z.T_RS.p.allFinite() || !z.T_RS.R.allFinite()) return {};
      return EmSample{z.T_RS.p, z.T_RS.Quaternion()};
    });
  }
  if (recording.strain0) {
    Replace(strain_, recording.strain0->moments_Nm,
            [](const StrainMeasurement& z) -> std::optional<Eigen::Vector4d> {
              if (!z.moments_Nm.allFinite()) return {};
              return z.moments_Nm;
            });
  }
  if (recording.load0) {
    Replace(load_, recording.load0->f_tip_N,
            [](const LoadMeasurement& z) -> std::optional<Eigen::Vector3d> {
              if (!z.f_tip_N.allFinite()) return {};
              return z.f_tip_N;
            });
  }
}

}  // namespace flextip::simulation
