// What predicts a stream at an instant, from the motion of a reference: coordinates, bending that
// grows with them, play and friction that remember the direction of motion.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calibration/clock/smooth_motion.h"

namespace flextip {

/// Features of a reference over its own time. The first kind is free, each further kind is expected
/// to be small: its size is estimated from the data.
class Predictors {
 public:
  /// Features that share a size.
  struct Kind {
    Eigen::Index first = 0, count = 0;
  };

  explicit Predictors(const Motion& reference);

  /// Tells whether play between the measured wrist and the shaft's can be set.
  bool HasPlay() const { return reference_.port.has_value(); }
  /// Sets the play (full width, m, per axis); a wrist only. 0 without a call.
  void SetPlay(double width_m);

  const std::vector<Kind>& Kinds() const { return kinds_; }
  Eigen::Index Count() const { return kinds_.back().first + kinds_.back().count; }
  /// The first feature that is not linear in the reference's coordinates.
  Eigen::Index FirstSmall() const { return kinds_[0].count; }
  /// Writes the features and, where asked for, their velocities (per s) at the reference's time
  /// `t_s`. Returns false, and writes nothing, outside the samples and in gaps.
  bool At(double t_s, Eigen::VectorXd& value, Eigen::VectorXd* velocity) const;
  const SmoothMotion& Smooth() const { return smooth_; }
  bool IsForce() const { return reference_.is_force; }

 private:
  /// Writes the features of one column of `course_`.
  void Features(const Eigen::VectorXd& at, Eigen::VectorXd& f) const;

  Motion reference_;
  SmoothMotion smooth_;
  double first_s_ = 0.0, step_s_ = 1.0;
  Eigen::MatrixXd base_;    // the reference's coordinates, a column an instant
  Eigen::MatrixXd course_;  // the same after the play, then the states of friction
  std::vector<bool> known_;
  Eigen::VectorXd middle_, size_;
  std::vector<Kind> kinds_;
};

}  // namespace flextip
