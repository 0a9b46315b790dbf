// One short closed loop for any set of sensors: plant -> sensors -> estimation, over one sample or
// a window -> control -> wrist. Private to reproduction.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

#include "estimation/shaft_estimator.h"

namespace flextip::reproduction {

/// What is measured besides the pose of the wrist.
struct SensorSet {
  const char* name = "";
  bool load = false, strain = false;
  bool em_direction = false, em_position = false;  ///< by a sensor 20 mm from the tip
  bool tip = false, tip_direction = false;         ///< by vision

  /// The tip's position is measured, by whichever sensor.
  bool SeesTip() const { return tip || em_position; }
};

enum class SensorModel { kStraight, kFlex, kRod };
enum class SensorMove {
  kPress,    ///< 10 mm into soft tissue
  kLateral,  ///< 10 mm across, out of the plane of bending, under a constant force
};

struct SensorCase {
  SensorSet sensors;
  SensorModel model = SensorModel::kRod;  ///< tracks a seen tip, else calculates the tip
  SensorMove move = SensorMove::kPress;
  double port_off_m = 0.0;  ///< true port from the registered one, across the shaft
  double port_prior_m = kPortRegistration_m;  ///< standard deviation of the port's prior
  bool window = false;                        ///< estimate over a window
  std::uint64_t seed = 1;
};

struct SensorRun {
  double tip_rms_m = 0.0;   ///< error of the controller's tip against the true tip
  double path_max_m = 0.0;  ///< true tip from the path
  double path_rms_m = 0.0;
  int updates = 0;
  int without_model = 0;  ///< updates with the straight shaft in place of a model, or no estimate
  bool lost = false;      ///< the plant found no equilibrium: the numbers go as far as that
};

/// The wrist first wanders for a second with the tip free of control, then the move is made. The
/// straight shaft goes by the registered port, the others by the estimated one.
SensorRun RunSensorCase(const SensorCase& setup);

}  // namespace flextip::reproduction
