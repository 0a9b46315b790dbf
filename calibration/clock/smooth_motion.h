// A motion smoothed in time, with its velocity.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calibration/clock/motion.h"

namespace flextip {

/// Local quadratic fits with Gaussian weights of `bandwidth_s`, joined by cubic pieces. The weights
/// are symmetric, so that smoothing does not delay. See Fan and Gijbels, Local Polynomial Modelling
/// and Its Applications, 1996, ch. 3.
class SmoothMotion {
 public:
  SmoothMotion(const Motion& motion, double bandwidth_s);

  /// Writes value and velocity (per s) of all rows at `t_s`. Returns false, and writes nothing,
  /// outside the samples and in gaps.
  bool At(double t_s, Eigen::VectorXd& value, Eigen::VectorXd& velocity) const;
  /// Returns the length of the velocity of the first `rows` rows; NaN where it is not known.
  double SpeedAt(double t_s, int rows) const;
  double BeginSeconds() const { return first_s_; }
  double EndSeconds() const;

 private:
  bool Fit(const Motion& motion, double bandwidth_s, double t_s, std::size_t& from,
           Eigen::Index knot);

  double first_s_ = 0.0, step_s_ = 1.0;
  Eigen::MatrixXd values_, slopes_;  // a column a knot
  std::vector<bool> known_;
};

/// Returns a bandwidth for a motion of a person or robot: 30 ms, or two and a half samples.
double UsualBandwidth(const Motion& motion);

}  // namespace flextip
