// From any set of sensors over a window of time to load, port and shape: the port stays where it is
// while the tip moves, so many instants say together where it is.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

#include "estimation/shaft_estimator.h"
#include "estimation/window_port.h"

namespace flextip {

struct WindowOptions {
  EstimatorOptions estimator;  ///< its `port_prior_m` may be wide: several mm
  int samples = 30;            ///< kept, spread over where the wrist was
};

enum class WindowStatus : std::uint8_t {
  kOk,
  kUnobservable,  ///< the port is not narrowed along `least_known`: there the registration stands
  kNotConverged,  ///< no rod fits any sample: the registration stands
};
const char* Name(WindowStatus status);

struct WindowEstimate {
  WindowStatus status = WindowStatus::kUnobservable;
  /// The estimate of the latest sample. Its prior of the port comes from the earlier samples, or
  /// from the registration as long as they do not narrow it.
  ShaftEstimate shaft;
  Eigen::Vector3d port_shift_m = Eigen::Vector3d::Zero();  ///< from where it is registered
  Eigen::Matrix3d port_covariance_m2 = Eigen::Matrix3d::Zero();
  /// Unit, across the shaft: where the port is known least, and how well. Along the shaft it does
  /// not matter and is never known.
  Eigen::Vector3d least_known = Eigen::Vector3d::UnitX();
  double least_known_sd_m = 0.0;
  double chi2 = 0.0;  ///< of the window, with the port's prior
  int samples = 0;
};

/// Unknowns: one shift of the port, and wrist and tip force of every sample. An update fits the
/// latest sample (ShaftEstimator), adds it and refines the whole window; it allocates nothing and
/// takes 1 to 2 ms with 30 samples (docs/results/reproduction/sensors.md). A port that moves needs
/// Reset().
class WindowEstimator {
 public:
  explicit WindowEstimator(const WindowOptions& options);

  WindowEstimate Update(const Measurements& measurements, const ShaftChange& change = {});

  /// Forgets the past.
  void Reset();

  void VisitState(StateText& state) {
    state(latest_);
    state(port_);
    state(status_);
    state(updates_);
  }

 private:
  void Add(const Measurements& measurements, const ShaftChange& change,
           const ShaftEstimate& estimate);
  void Describe(WindowEstimate& estimate) const;
  void TellLatest();

  WindowOptions options_;
  ShaftEstimator latest_;
  WindowPort port_;
  WindowStatus status_ = WindowStatus::kUnobservable;  // of the last update
  long updates_ = 0;
};

}  // namespace flextip
