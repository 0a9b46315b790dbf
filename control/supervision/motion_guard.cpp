#include "control/supervision/motion_guard.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/motion_error.h"
#include "control/wrist_step.h"

namespace flextip {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

constexpr double kAxesRate_hz = 9.0 * 30.0;  // axes a second: some 5 ms of a processor

// Nobody presses a shaft with more than a third of the load under which it buckles (the usual
// safety factor against buckling); Euler's load of a shaft held at one end is pi^2 / 4 EI / L^2.
// Taken as two standard deviations of each component of the tip force.
constexpr double kForceSd_units = std::numbers::pi * std::numbers::pi / 4.0 / 3.0 / 2.0;

/// Wrist, port and tip force with that knowledge of the force. An estimate's own prior is far
/// wider, and the force along the shaft is often known by it alone.
struct Plausible {
  Vector9d shift = Vector9d::Zero();  ///< of the mean from the estimate
  Matrix9d covariance;
};

Plausible WithPlausibleForce(const ShaftEstimate& estimate) {
  const Instrument& instrument = estimate.model.instrument;
  const double sd_N = kForceSd_units * instrument.bending_stiffness_Nm2 /
                      (instrument.length_m * instrument.length_m);
  const Matrix9d& C = estimate.covariance;
  Eigen::Matrix3d seen = C.bottomRightCorner<3, 3>();
  seen.diagonal().array() += sd_N * sd_N;
  const Eigen::Matrix<double, 9, 3> gain = C.rightCols<3>() * seen.inverse();
  return {-gain * estimate.model.f_tip_N, C - gain * C.bottomRows<3>()};
}

}  // namespace

MotionGuard::MotionGuard(double deviations, double max_tissue_gain, double rate_hz)
    : deviations_(deviations),
      max_tissue_gain_(max_tissue_gain),
      axes_a_cycle_(std::clamp(static_cast<int>(kAxesRate_hz / rate_hz), 1, kAxes)) {}

void MotionGuard::LookAt(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW,
                         const Vector9d& shift, End& end) {
  ShaftModel model = estimate.model;
  model.p_RP += shift.segment<3>(3);
  model.f_tip_N += shift.tail<3>();
  const ShaftRodState rod = end.rod.Solve(RodOf(model, p_RW + shift.head<3>()));
  end.state = rod.IsUsable() ? End::State::kFound : End::State::kBuckled;
  if (!rod.IsUsable()) return;
  const Eigen::Matrix3d C = rod.dp_RE.rightCols<3>();
  const Eigen::Matrix3d K = TrustedStiffness(model.tissue_stiffness_N_m, C, max_tissue_gain_);
  end.J = (Eigen::Matrix3d::Identity() - C * K).inverse() * rod.dp_RE.leftCols<3>();
}

void MotionGuard::Update(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW) {
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (!fitted || !estimate.covariance.allFinite()) {
    for (End& end : ends_) end.state = End::State::kUnknown;
    return;
  }
  const auto [mean, covariance] = WithPlausibleForce(estimate);
  for (int i = 0; i < axes_a_cycle_; ++i) {
    // The axis through the ellipsoid's surface in the direction of one parameter: a column of the
    // covariance over that parameter's deviation.
    const double sd = std::sqrt(std::max(0.0, covariance(axis_, axis_)));
    Vector9d shift = Vector9d::Zero();
    if (sd > 0.0) shift = deviations_ / sd * covariance.col(axis_);
    for (const int side : {0, 1}) {
      const std::size_t at = 2 * static_cast<std::size_t>(axis_) + static_cast<std::size_t>(side);
      LookAt(estimate, p_RW, mean + (side == 0 ? 1.0 : -1.0) * shift, ends_[at]);
    }
    axis_ = (axis_ + 1) % kAxes;
  }
}

double MotionGuard::WorstAngle(const Eigen::Matrix3d& J_hat) const {
  double largest_rad = 0.0;
  for (const End& end : ends_) {
    if (end.state == End::State::kUnknown) continue;
    if (end.state == End::State::kBuckled || !J_hat.allFinite()) return std::numbers::pi;
    largest_rad = std::max(largest_rad, FindLargestAngle(end.J, J_hat).phi_max_rad);
  }
  return largest_rad;
}

std::optional<Eigen::Matrix3d> MotionGuard::Jacobian() const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  int found = 0;
  for (const End& end : ends_) {
    if (end.state != End::State::kFound) continue;
    sum += end.J;
    ++found;
  }
  if (found == 0) return {};
  return sum / found;
}

double MotionGuard::StepAngle(const Eigen::Vector3d& dp_RE_wanted,
                              const Eigen::Vector3d& dp_RW) const {
  double largest_rad = 0.0;
  for (const End& end : ends_) {
    if (end.state == End::State::kUnknown) continue;
    if (end.state == End::State::kBuckled) return std::numbers::pi;
    const Eigen::Vector3d dp_RE = end.J * dp_RW;
    const double angle_rad = std::atan2(dp_RE.cross(dp_RE_wanted).norm(), dp_RE.dot(dp_RE_wanted));
    largest_rad = std::max(largest_rad, angle_rad);
  }
  return largest_rad;
}

}  // namespace flextip
