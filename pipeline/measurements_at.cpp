#include "pipeline/measurements_at.h"

#include <algorithm>
#include <cmath>

#include "recording/resample.h"

namespace flextip {
namespace {

/// A registration's uncertainty adds to every sample's noise, as far as one sample can tell.
double Combined(double noise, double registration) { return std::hypot(noise, registration); }

std::optional<TipObservation> TipExactlyAt(const VisionStream& stream, TimeNs t_ns) {
  const auto tip = TipAt(stream, t_ns);
  if (!tip || tip->t_ns != t_ns || tip->value.status == TipStatus::kLost) return {};
  TipObservation observation = tip->value;
  observation.covariance_m2 +=
      stream.registration_noise_m * stream.registration_noise_m * Eigen::Matrix3d::Identity();
  return observation;
}

}  // namespace

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

std::optional<Measurements> MeasurementsAt(const Recording& recording, TimeNs t_ns) {
  if (!recording.wrist0) return {};
  const auto wrist = WristAt(*recording.wrist0, t_ns);
  if (!wrist) return {};
  Measurements z;
  z.p_RW = wrist->p_RW;
  z.wrist_position_noise_m = recording.wrist0->position_noise_m;
  if (wrist->q_RW) z.R_RW = wrist->q_RW->toRotationMatrix();
  z.wrist_orientation_noise_rad = recording.wrist0->orientation_noise_rad;
  if (recording.vision0) {
    const VisionStream& vision = *recording.vision0;
    z.tip = TipExactlyAt(vision, t_ns);
    z.tip_direction_noise_rad = Combined(vision.direction_noise_rad, vision.registration_noise_rad);
  }
  if (recording.em0) {
    const EmStream& em = *recording.em0;
    if (const auto sample = EmAt(em, t_ns)) {
      z.em = EmMeasurement{Pose::FromQuaternion(sample->q_RS, sample->p_RS), em.distance_from_tip_m,
                           Combined(em.position_noise_m, em.registration_noise_m),
                           Combined(em.orientation_noise_rad, em.registration_noise_rad)};
    }
  }
  if (recording.em1) {
    const EmStream& em = *recording.em1;
    if (const auto sample = EmAt(em, t_ns)) {
      z.port_direction = sample->q_RS.toRotationMatrix().col(0);
      z.port_direction_noise_rad = Combined(em.orientation_noise_rad, em.registration_noise_rad);
    }
  }
  if (recording.strain0) {
    const StrainStream& strain = *recording.strain0;
    if (const auto moments = StrainAt(strain, t_ns)) {
      z.strain = StrainMeasurement{*moments,
                                   {strain.station_from_wrist_m[0], strain.station_from_wrist_m[1]},
                                   strain.moment_noise_Nm};
    }
  }
  if (recording.load0) {
    const auto f = LoadAt(*recording.load0, t_ns);
    if (f) z.load = LoadMeasurement{*f, recording.load0->force_noise_N};
  }
  return z;
}

}  // namespace flextip
