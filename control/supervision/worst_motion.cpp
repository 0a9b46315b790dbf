#include "control/supervision/worst_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "control/motion_error.h"
#include "control/wrist_step.h"

namespace flextip {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

constexpr int kClimbs = 2, kSteps = 4;
constexpr double kDifference = 0.05;  // of the ellipsoid's half axes
constexpr double kWorthwhile = 1e-4;  // a step's gain, of the angle

/// L with L L^T = C for a C that is positive semidefinite up to rounding: axes without doubt stay
/// without.
Matrix9d RootOf(const Matrix9d& C) {
  Matrix9d L = Matrix9d::Zero();
  for (int j = 0; j < 9; ++j) {
    const double pivot = C(j, j) - L.row(j).head(j).squaredNorm();
    if (!(pivot > 1e-12 * C(j, j))) continue;
    L(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 9; ++i)
      L(i, j) = (C(i, j) - L.row(i).head(j).dot(L.row(j).head(j))) / L(j, j);
  }
  return L;
}

/// The angle as a function of a place in the unit ball.
class Doubt {
 public:
  Doubt(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW,
        const ControllerOptions& options, double deviations)
      : J_hat_(J_hat),
        model_(estimate.model),
        p_RW_(p_RW),
        gain_limit_(options.max_tissue_gain),
        root_(deviations * RootOf(estimate.covariance)) {}

  std::optional<AngleError<3>> At(const Vector9d& z) {
    const Vector9d x = root_ * z;
    ShaftModel model = model_;
    model.p_RP += x.segment<3>(3);
    model.f_tip_N += x.tail<3>();
    const ShaftRodState rod = rod_.Solve(RodOf(model, p_RW_ + x.head<3>()));
    if (!rod.IsUsable()) return {};
    const Eigen::Matrix3d C = rod.dp_RE.rightCols<3>();
    const Eigen::Matrix3d K = TrustedStiffness(model.tissue_stiffness_N_m, C, gain_limit_);
    const Eigen::Matrix3d J =
        (Eigen::Matrix3d::Identity() - C * K).inverse() * rod.dp_RE.leftCols<3>();
    return FindLargestAngle(J, J_hat_);
  }
  double ValueAt(const Vector9d& z) {
    const auto angle = At(z);
    return angle ? angle->phi_max_rad : std::numbers::pi;
  }

  /// Follows the steepest way along the ball's surface. Returns the largest value.
  double Climb(Vector9d& z) {
    double best = ValueAt(z);
    for (int step = 0; step < kSteps && best < std::numbers::pi; ++step) {
      Vector9d gradient;
      for (int i = 0; i < 9; ++i) {
        const Vector9d d = kDifference * Vector9d::Unit(i);
        gradient[i] = ValueAt(z + d) - ValueAt(z - d);
      }
      if (!(gradient.norm() > 0.0)) break;
      const Vector9d next = gradient.normalized();
      const double value = ValueAt(next);
      if (!(value > best * (1.0 + kWorthwhile))) break;
      best = value;
      z = next;
    }
    return best;
  }

 private:
  Eigen::Matrix3d J_hat_;
  ShaftModel model_;
  Eigen::Vector3d p_RW_;
  double gain_limit_;
  Matrix9d root_;
  ShaftRod rod_;
};

}  // namespace

WorstMotion FindWorstMotion(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                            const Eigen::Vector3d& p_RW, const ControllerOptions& options,
                            double deviations) {
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (!fitted || !J_hat.allFinite() || !estimate.covariance.allFinite()) return {};
  Doubt doubt(J_hat, estimate, p_RW, options, deviations);
  const auto at_estimate = doubt.At(Vector9d::Zero());
  if (!at_estimate || !at_estimate->IsUsable()) return {};
  WorstMotion worst{true, at_estimate->phi_max_rad, at_estimate->phi_max_rad, at_estimate->p_phi};

  struct Start {
    double value = 0.0;
    Vector9d z = Vector9d::Zero();
  };
  std::array<Start, 18> starts;
  for (int i = 0; i < 18; ++i) {
    starts[i].z = (i % 2 ? 1.0 : -1.0) * Vector9d::Unit(i / 2);
    starts[i].value = doubt.ValueAt(starts[i].z);
  }
  std::partial_sort(starts.begin(), starts.begin() + kClimbs, starts.end(),
                    [](const Start& a, const Start& b) { return a.value > b.value; });
  for (int i = 0; i < kClimbs; ++i) {
    const double value = doubt.Climb(starts[i].z);
    if (!(value > worst.angle_rad)) continue;
    worst.angle_rad = value;
    if (const auto angle = doubt.At(starts[i].z)) worst.direction = angle->p_phi;
  }
  return worst;
}

}  // namespace flextip
