// What a trial of the user study is made of (5.2.6). Private to reproduction.
#pragma once

#include <random>

#include "estimation/shaft_estimator.h"
#include "reproduction/chapter5/trial.h"
#include "simulation/sensors/sensors.h"

namespace flextip::reproduction {

inline constexpr double kSensorFromTip_m = 0.02;  // 5.2.6
inline constexpr double kEncoderNoise_m = 1e-5;   // Phantom Premium 1.5: 0.03 mm resolution

/// Stainless steel, 600 mm x 2.38 mm.
Instrument Rod();
inline const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

/// How often the plant is solved: a multiple of the update rate.
double TickRate(const TrialSetup& setup);
simulation::SensorSetup MakeSensors(const TrialSetup& setup, const TrialPlaces& places);
EstimatorOptions MakeEstimator(const TrialSetup& setup, const TrialPlaces& places);
ControllerOptions MakeController(const TrialSetup& setup);
simulation::OperatorTask MakeTask(const TrialPlaces& places);

/// Now and then something stands before the camera: 5 % of the time, 0.3 s on average.
class Occlusions {
 public:
  explicit Occlusions(std::uint64_t seed) : rng_(seed) {}
  bool Step(double dt_s) {
    left_s_ -= dt_s;
    if (left_s_ <= 0.0) {
      hidden_ = !hidden_;
      left_s_ = std::exponential_distribution<double>(hidden_ ? 1.0 / 0.3 : 1.0 / 5.7)(rng_);
    }
    return hidden_;
  }

 private:
  std::mt19937_64 rng_;
  bool hidden_ = true;  // the first draw turns it
  double left_s_ = 0.0;
};

}  // namespace flextip::reproduction
