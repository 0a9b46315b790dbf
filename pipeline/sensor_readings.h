// From the sensors' samples to estimation's measurements: the only gathering there is.
#pragma once

#include <optional>
#include <vector>

#include "core/time_series.h"
#include "estimation/saved_state.h"
#include "recording/recording.h"

namespace flextip {

/// The wrist by the robot's encoders. In R; m, rad, standard deviations per axis.
struct WristMeasurement {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  std::optional<Eigen::Matrix3d> R_RW;  ///< where the free joint's orientation is measured
  double position_noise_m = 0.0;
  double orientation_noise_rad = 0.0;
};

/// The tip by vision.
struct TipMeasurement {
  TipObservation tip;
  double direction_noise_rad = 0.0;  ///< of `tip.d_RE`, per axis across it
};

/// One sample of each sensor, with the time and the noise of the sample. Absent: no sample.
/// Fixed size. A registration's uncertainty is part of the noise.
struct SensorReadings {
  std::optional<Sample<WristMeasurement>> wrist;
  std::optional<Sample<TipMeasurement>> tip;
  std::optional<Sample<EmMeasurement>> em0;  ///< on the shaft
  std::optional<Sample<EmMeasurement>> em1;  ///< on the port
  std::optional<Sample<StrainMeasurement>> strain;
  std::optional<Sample<LoadMeasurement>> load;
};

void VisitState(WristMeasurement& wrist, StateText& state);
void VisitState(TipMeasurement& tip, StateText& state);
void VisitState(SensorReadings& readings, StateText& state);

/// Returns a stream's sample with the stream's noise.
WristMeasurement Measured(const WristStream& stream, const WristSample& sample);
TipMeasurement Measured(const VisionStream& stream, const TipObservation& tip);
EmMeasurement Measured(const EmStream& stream, const EmSample& sample);
StrainMeasurement Measured(const StrainStream& stream, const Eigen::Vector4d& moments_Nm);
LoadMeasurement Measured(const LoadStream& stream, const Eigen::Vector3d& f_tip_N);

/// Returns the sensors of a recording at `t_ns`, interpolated between the neighbouring samples. The
/// tip by vision is there only at the times of its own frames.
SensorReadings ReadingsAt(const Recording& recording, TimeNs t_ns);

/// Returns the last sample of each stream of a recording in the making.
SensorReadings NewestReadings(const Recording& recording);

/// Returns the measurements for estimation. Empty where the wrist is not known. A lost tip is left
/// out.
std::optional<Measurements> Gather(const SensorReadings& readings);

/// Returns Gather(ReadingsAt(recording, t_ns)).
std::optional<Measurements> MeasurementsAt(const Recording& recording, TimeNs t_ns);

/// Returns every time at which the wrist or the tip was sampled, in order.
std::vector<TimeNs> EstimationTimes(const Recording& recording);

}  // namespace flextip
