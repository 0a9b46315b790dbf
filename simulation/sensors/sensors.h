// The sensors on the simulated instrument: each at its own rate, with its own noise and seed.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "recording/recording.h"
#include "simulation/plant/shape.h"
#include "simulation/sensors/effects.h"
#include "simulation/sensors/em_field.h"
#include "simulation/sensors/pose_history.h"

namespace flextip::simulation {

/// A tip tracker by its figures, for runs without rendered frames: noise across the camera's line
/// of sight and along it.
struct TipSensorSetup {
  double rate_hz = 30.0;
  double across_noise_m = 0.0001;
  double depth_noise_m = 0.0005;
  double direction_noise_rad = 0.003;
  Eigen::Vector3d line_of_sight = Eigen::Vector3d::UnitZ();  ///< in R, unit
  Pose T_RC;  ///< camera as registered: matters only where it or its focal length is off
  std::string comment = "tip tracker, simulated by its figures";
};

/// Which sensors there are. The streams' samples are empty here: they state rates and noises.
struct SensorSetup {
  std::optional<WristStream> wrist;
  std::optional<EmStream> em0, em1;
  std::optional<StrainStream> strain;
  std::optional<LoadStream> load;
  std::optional<TipSensorSetup> tip;
};

/// Returns how many samples (1/s) all sensors take together.
double SamplesPerSecond(const SensorSetup& setup);

/// Noise of one sensor: white, or with `correlation` a from sample to sample,
/// x_k = a x_{k-1} + sqrt(1 - a^2) w_k, of the same variance.
class SensorNoise {
 public:
  SensorNoise(std::uint64_t seed, NoiseDistribution distribution, double scale = 1.0,
              double correlation = 0.0)
      : rng_(seed), distribution_(distribution), scale_(scale), correlation_(correlation) {}
  /// Draws noise with standard deviation `sd` per axis, times the scale, for either distribution.
  /// `which` is the index of the sensor's vector: each vector has its own past.
  Eigen::Vector3d Vector(double sd, int which = 0);

 private:
  double Draw();
  std::mt19937_64 rng_;
  NoiseDistribution distribution_;
  double scale_, correlation_;
  std::optional<Eigen::Vector3d> last_[2];
  std::normal_distribution<double> normal_;
};

/// Samples every sensor that is due.
class Sensors {
 public:
  Sensors(const SensorSetup& setup, std::uint64_t seed, const SensorEffects& effects = {});

  /// Adds the samples that fall due in (last call, t_ns] to `recording`'s streams, all taken from
  /// `shape` at the time they are due; a sensor with latency takes them from the earlier shape.
  /// Call it with increasing times, and for latency often enough that a cubic follows the motion.
  /// Before kSimulationStart_ns nothing is due: such calls only give the latencies their past.
  void Sample(const PlantShape& shape, TimeNs t_ns, Recording& recording);

  /// Changes the effects from now on, but for the noise's.
  void SetEffects(const SensorEffects& effects);

  /// Returns the time at which the next sample of any sensor is due; empty without sensors.
  std::optional<TimeNs> NextDue() const;

 private:
  /// One sensor's clock and noise.
  struct Channel {
    SensorNoise noise;
    TimeNs next_ns;
    /// Returns whether a sample is due at `t_ns`; moves the clock on.
    bool Due(double rate_hz, TimeNs t_ns);
  };
  Channel MakeChannel(std::uint64_t seed, int sensor, const std::optional<EmStream>& em = {}) const;

  void Remember(const PlantShape& shape, TimeNs t_ns);
  void SampleWrist(const Pose& T_RW, TimeNs t_ns, Recording& recording);
  void SampleEm(const Pose& T_RS, TimeNs t_ns, const EmStream& setup, Channel& channel,
                std::optional<EmStream>& stream);
  void SampleStrain(const PlantShape& shape, TimeNs t_ns, Recording& recording);
  void SampleTip(const Pose& T_RE, TimeNs t_ns, Recording& recording);

  SensorSetup setup_;
  SensorEffects effects_;
  EmField em_field_;
  PoseHistory em0_history_, em1_history_, tip_history_;
  Channel wrist_, em0_, em1_, strain_, load_, tip_;
};

/// Simulated recordings start here: a round time stamp in nanoseconds.
inline constexpr TimeNs kSimulationStart_ns = 1'700'000'000'000'000'000;

}  // namespace flextip::simulation
