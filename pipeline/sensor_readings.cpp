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

}  // namespace

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
