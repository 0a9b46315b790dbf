#include "pipeline/sensor_readings.h"

#include <algorithm>
#include <cmath>

#include "recording/resample.h"

namespace flextip {
namespace {

/// The noise of a sample in R: a registration's uncertainty adds to that of every sample.
double Combined(double noise, double registration) { return std::hypot(noise, registration); }

std::optional<Sample<TipMeasurement>> TipExactlyAt(const VisionStream& stream, TimeNs t_ns) {
  const auto tip = TipAt(stream, t_ns);
  if (!tip || tip->t_ns != t_ns) return {};
  return Sample<TipMeasurement>{t_ns, Measured(stream, tip->value)};
}

/// Returns the speed of a place around `t_ns` (m/s), from the samples beside it that have one
/// (`place` returns it, or nothing); zero where there are none.
template <class Value, class Place>
Eigen::Vector3d SpeedAt(const Series<Value>& series, TimeNs t_ns, const Place& place) {
  constexpr std::size_t kFarthest = 3;  // samples on either side
  const auto at = FindBracket(series, t_ns);
  if (!at) return Eigen::Vector3d::Zero();
  std::optional<Sample<Eigen::Vector3d>> first, last;
  const std::size_t begin = at->i > kFarthest ? at->i - kFarthest : 0;
  for (std::size_t i = begin; i < std::min(series.size(), at->i + kFarthest + 2); ++i) {
    const std::optional<Eigen::Vector3d> p = place(series[i].value);
    if (!p) continue;
    if (!first || series[i].t_ns < t_ns) first = {series[i].t_ns, *p};
    last = {series[i].t_ns, *p};
    if (series[i].t_ns > t_ns && first->t_ns < last->t_ns) break;
  }
  if (!first || last->t_ns == first->t_ns) return Eigen::Vector3d::Zero();
  return (last->value - first->value) / (1e-9 * static_cast<double>(last->t_ns - first->t_ns));
}

std::optional<Eigen::Vector3d> PlaceOf(const WristSample& sample) { return sample.p_RW; }
std::optional<Eigen::Vector3d> PlaceOf(const EmSample& sample) { return sample.p_RS; }
std::optional<Eigen::Vector3d> PlaceOf(const TipObservation& tip) {
  if (tip.status == TipStatus::kLost) return {};
  return tip.p_RE;
}

/// Returns how far a sample's time may have taken its place, by its speed (m).
template <class Value>
Eigen::Vector3d ByClock(const ClockNoise& clock, const Series<Value>& series, TimeNs t_ns) {
  const double sd_s = clock.SdAt(t_ns);
  if (sd_s == 0.0) return Eigen::Vector3d::Zero();
  return sd_s * SpeedAt(series, t_ns, [](const Value& value) { return PlaceOf(value); });
}

/// An isotropic noise with `by_clock_m` along one direction: of the same trace.
double WithClock(double noise_m, const Eigen::Vector3d& by_clock_m) {
  return std::hypot(noise_m, by_clock_m.norm() / std::sqrt(3.0));
}

template <class Stream, class Value>
auto Newest(const Stream& stream, const Series<Value>& samples)
    -> std::optional<Sample<decltype(Measured(stream, samples.back().value))>> {
  if (samples.empty()) return {};
  return {{samples.back().t_ns, Measured(stream, samples.back().value)}};
}

template <class Stream, class Value>
auto Interpolated(const Stream& stream, const std::optional<Value>& value, TimeNs t_ns)
    -> std::optional<Sample<decltype(Measured(stream, *value))>> {
  if (!value) return {};
  return {{t_ns, Measured(stream, *value)}};
}

/// The clocks' deviations enter by the speed.
void AddClocks(const Recording& r, TimeNs t_ns, SensorReadings& readings) {
  if (readings.wrist) {
    double& noise_m = readings.wrist->value.position_noise_m;
    noise_m = WithClock(noise_m, ByClock(r.wrist0->clock, r.wrist0->samples, t_ns));
  }
  if (readings.em0) {
    double& noise_m = readings.em0->value.position_noise_m;
    noise_m = WithClock(noise_m, ByClock(r.em0->clock, r.em0->samples, t_ns));
  }
  if (readings.tip && readings.tip->value.tip.status != TipStatus::kLost) {
    const Eigen::Vector3d by_clock_m = ByClock(r.vision0->clock, r.vision0->tips, t_ns);
    readings.tip->value.tip.covariance_m2 += by_clock_m * by_clock_m.transpose();
  }
}

}  // namespace

void VisitState(WristMeasurement& wrist, StateText& state) {
  state(wrist.p_RW);
  state(wrist.R_RW);
  state(wrist.position_noise_m);
  state(wrist.orientation_noise_rad);
}

void VisitState(TipMeasurement& tip, StateText& state) {
  state(tip.tip);
  state(tip.direction_noise_rad);
}

void VisitState(SensorReadings& readings, StateText& state) {
  state(readings.wrist);
  state(readings.tip);
  state(readings.em0);
  state(readings.em1);
  state(readings.strain);
  state(readings.load);
}

WristMeasurement Measured(const WristStream& stream, const WristSample& sample) {
  WristMeasurement wrist{sample.p_RW, {}, stream.position_noise_m, stream.orientation_noise_rad};
  if (sample.q_RW) wrist.R_RW = sample.q_RW->toRotationMatrix();
  return wrist;
}

TipMeasurement Measured(const VisionStream& stream, const TipObservation& tip) {
  TipMeasurement measured{tip, Combined(stream.direction_noise_rad, stream.registration_noise_rad)};
  measured.tip.covariance_m2 +=
      stream.registration_noise_m * stream.registration_noise_m * Eigen::Matrix3d::Identity();
  return measured;
}

EmMeasurement Measured(const EmStream& stream, const EmSample& sample) {
  return {Pose::FromQuaternion(sample.q_RS, sample.p_RS), stream.distance_from_tip_m,
          Combined(stream.position_noise_m, stream.registration_noise_m),
          Combined(stream.orientation_noise_rad, stream.registration_noise_rad)};
}

StrainMeasurement Measured(const StrainStream& stream, const Eigen::Vector4d& moments_Nm) {
  return {moments_Nm,
          {stream.station_from_wrist_m[0], stream.station_from_wrist_m[1]},
          stream.moment_noise_Nm};
}

LoadMeasurement Measured(const LoadStream& stream, const Eigen::Vector3d& f_tip_N) {
  return {f_tip_N, stream.force_noise_N};
}

SensorReadings ReadingsAt(const Recording& r, TimeNs t_ns) {
  SensorReadings readings;
  if (r.wrist0) readings.wrist = Interpolated(*r.wrist0, WristAt(*r.wrist0, t_ns), t_ns);
  if (r.vision0) readings.tip = TipExactlyAt(*r.vision0, t_ns);
  if (r.em0) readings.em0 = Interpolated(*r.em0, EmAt(*r.em0, t_ns), t_ns);
  if (r.em1) readings.em1 = Interpolated(*r.em1, EmAt(*r.em1, t_ns), t_ns);
  if (r.strain0) readings.strain = Interpolated(*r.strain0, StrainAt(*r.strain0, t_ns), t_ns);
  if (r.load0) readings.load = Interpolated(*r.load0, LoadAt(*r.load0, t_ns), t_ns);
  AddClocks(r, t_ns, readings);
  return readings;
}

SensorReadings NewestReadings(const Recording& r) {
  SensorReadings readings;
  if (r.wrist0) readings.wrist = Newest(*r.wrist0, r.wrist0->samples);
  if (r.vision0) readings.tip = Newest(*r.vision0, r.vision0->tips);
  if (r.em0) readings.em0 = Newest(*r.em0, r.em0->samples);
  if (r.em1) readings.em1 = Newest(*r.em1, r.em1->samples);
  if (r.strain0) readings.strain = Newest(*r.strain0, r.strain0->moments_Nm);
  if (r.load0) readings.load = Newest(*r.load0, r.load0->f_tip_N);
  return readings;
}

std::optional<Measurements> Gather(const SensorReadings& readings) {
  std::optional<Measurements> gathered;
  if (!readings.wrist) return gathered;
  const WristMeasurement& wrist = readings.wrist->value;
  Measurements& z = gathered.emplace();
  z.p_RW = wrist.p_RW;
  z.wrist_position_noise_m = wrist.position_noise_m;
  z.R_RW = wrist.R_RW;
  z.wrist_orientation_noise_rad = wrist.orientation_noise_rad;
  if (readings.tip && readings.tip->value.tip.status != TipStatus::kLost) {
    z.tip = readings.tip->value.tip;
    z.tip_direction_noise_rad = readings.tip->value.direction_noise_rad;
  }
  if (readings.em0) z.em = readings.em0->value;
  if (readings.em1) {
    z.port_direction = readings.em1->value.T_RS.R.col(0);
    z.port_direction_noise_rad = readings.em1->value.orientation_noise_rad;
  }
  if (readings.strain) z.strain = readings.strain->value;
  if (readings.load) z.load = readings.load->value;
  return gathered;
}

std::optional<Measurements> MeasurementsAt(const Recording& recording, TimeNs t_ns) {
  return Gather(ReadingsAt(recording, t_ns));
}

std::vector<TimeNs> EstimationTimes(const Recording& recording) {
  std::vector<TimeNs> times;
  if (recording.wrist0) times = TimesOf(recording.wrist0->samples);
  if (recording.vision0) {
    const auto tips = TimesOf(recording.vision0->tips);
    times.insert(times.end(), tips.begin(), tips.end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace flextip
