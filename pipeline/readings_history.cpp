#include "pipeline/readings_history.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace flextip {
namespace {

constexpr TimeNs kApart_ns = 4'000'000;
constexpr TimeNs kVelocitySpan_ns = 20'000'000;  // to either side

Eigen::Matrix3d Between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, double u) {
  return Interpolate(Eigen::Quaterniond(a), Eigen::Quaterniond(b), u).toRotationMatrix();
}
// The noise is that of the earlier sample.
WristMeasurement Between(WristMeasurement a, const WristMeasurement& b, double u) {
  a.p_RW = Interpolate(a.p_RW, b.p_RW, u);
  if (a.R_RW && b.R_RW) a.R_RW = Between(*a.R_RW, *b.R_RW, u);
  return a;
}
EmMeasurement Between(EmMeasurement a, const EmMeasurement& b, double u) {
  a.T_RS = {Between(a.T_RS.R, b.T_RS.R, u), Interpolate(a.T_RS.p, b.T_RS.p, u)};
  return a;
}
StrainMeasurement Between(StrainMeasurement a, const StrainMeasurement& b, double u) {
  a.moments_Nm += u * (b.moments_Nm - a.moments_Nm);
  return a;
}
LoadMeasurement Between(LoadMeasurement a, const LoadMeasurement& b, double u) {
  a.f_tip_N = Interpolate(a.f_tip_N, b.f_tip_N, u);
  return a;
}

}  // namespace

void ReadingsHistory::VisitState(StateText& state) {
  state(count_);
  if (count_ > kSize) throw InputError("saved state: more readings than are kept");
  // The oldest comes first, wherever the ring began.
  if (state.Reading()) first_ = 0;
  for (std::size_t i = 0; i < count_; ++i) state(ring_[(first_ + i) % kSize]);
}

void ReadingsHistory::Add(const SensorReadings& readings) {
  if (!readings.wrist) return;
  const auto t_ns = [this](std::size_t i) { return Of(i).wrist->t_ns; };
  if (count_ > 0 && readings.wrist->t_ns <= t_ns(count_ - 1)) return;
  // The last ones make room where they are too near to those before them.
  if (count_ > 1 && t_ns(count_ - 1) < t_ns(count_ - 2) + kApart_ns) --count_;
  if (count_ == kSize) {
    first_ = (first_ + 1) % kSize;
    --count_;
  }
  ring_[(first_ + count_) % kSize] = readings;
  ++count_;
}

template <class T>
std::optional<Sample<T>> ReadingsHistory::SampleAt(std::optional<Sample<T>> SensorReadings::*sensor,
                                                   TimeNs t_ns) const {
  const Sample<T>* after = nullptr;
  for (std::size_t i = count_; i-- > 0;) {
    const std::optional<Sample<T>>& sample = Of(i).*sensor;
    if (!sample) continue;
    if (sample->t_ns > t_ns) {
      after = &*sample;
      continue;
    }
    if (after == nullptr || sample->t_ns == t_ns) return Sample<T>{t_ns, sample->value};
    const double u =
        static_cast<double>(t_ns - sample->t_ns) / static_cast<double>(after->t_ns - sample->t_ns);
    return Sample<T>{t_ns, Between(sample->value, after->value, u)};
  }
  return {};
}

std::optional<WristMeasurement> ReadingsHistory::WristAt(TimeNs t_ns) const {
  const auto wrist = SampleAt(&SensorReadings::wrist, t_ns);
  if (!wrist) return {};
  return wrist->value;
}

Eigen::Vector3d ReadingsHistory::WristDoubtAt(TimeNs t_ns) const {
  for (std::size_t i = count_; i-- > 1;) {
    const Sample<WristMeasurement>&before = *Of(i - 1).wrist, &after = *Of(i).wrist;
    if (t_ns >= after.t_ns) break;
    if (t_ns <= before.t_ns) continue;
    const double u =
        static_cast<double>(t_ns - before.t_ns) / static_cast<double>(after.t_ns - before.t_ns);
    return std::sqrt(u * (1.0 - u)) * (after.value.p_RW - before.value.p_RW);
  }
  return Eigen::Vector3d::Zero();
}

std::optional<SensorReadings> ReadingsHistory::At(TimeNs t_ns) const {
  SensorReadings then;
  then.wrist = SampleAt(&SensorReadings::wrist, t_ns);
  if (!then.wrist) return {};
  then.em0 = SampleAt(&SensorReadings::em0, t_ns);
  then.em1 = SampleAt(&SensorReadings::em1, t_ns);
  then.strain = SampleAt(&SensorReadings::strain, t_ns);
  then.load = SampleAt(&SensorReadings::load, t_ns);
  return then;
}

Eigen::Vector3d ReadingsHistory::WristVelocityAt(TimeNs t_ns) const {
  if (count_ < 2) return Eigen::Vector3d::Zero();
  const TimeNs from_ns = std::max(t_ns - kVelocitySpan_ns, Of(0).wrist->t_ns);
  const TimeNs to_ns = std::min(t_ns + kVelocitySpan_ns, Of(count_ - 1).wrist->t_ns);
  if (to_ns <= from_ns) return Eigen::Vector3d::Zero();
  return (WristAt(to_ns)->p_RW - WristAt(from_ns)->p_RW) /
         (1e-9 * static_cast<double>(to_ns - from_ns));
}

}  // namespace flextip
