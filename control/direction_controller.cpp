#include "control/direction_controller.h"

#include <algorithm>
#include <cmath>

#include "control/wrist_step.h"
#include "core/linear_algebra.h"
#include "core/place.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kFreedom = 0.05;  // rad of direction per shaft length of wrist that count as one

/// Of any length that is a number's: shorter or longer ones square to nothing, or to infinity.
bool IsDirection(const Eigen::Vector3d& d) {
  const double size = d.norm();
  return size > 1e-100 && size < 1e100;
}

bool IsPlausible(const DirectionInput& input) {
  const Eigen::Vector3d& axis = input.free_axis;
  return IsPlace(input.p_RW) && IsPlace(input.p_RE) && IsPlace(input.p_RE_desired) &&
         IsDirection(input.d_RE) && IsDirection(input.d_RE_desired) &&
         (axis.isZero(0.0) || IsDirection(axis));
}

bool IsPositive(double value) { return value > 0.0 && value <= kFarthestPlace_m; }

bool IsPlausible(const DirectionOptions& o) {
  return IsPositive(o.position_tolerance_m) && IsPositive(o.direction_tolerance_rad) &&
         std::isfinite(o.gain) && o.max_step_m >= 0.0 && o.max_step_m <= kFarthestPlace_m &&
         o.max_tissue_gain >= 1.0 && std::isfinite(o.max_tissue_gain) &&
         IsPositive(o.min_singular_value);
}

bool IsFinite(const TipJacobians& J) { return J.position.allFinite() && J.direction.allFinite(); }

bool IsFinite(const DirectionOutput& o) {
  return o.p_RW_command.allFinite() && std::isfinite(o.position_left_m) &&
         std::isfinite(o.direction_left_rad);
}

/// The inverse of J on what it moves by more than `least`, damped below (Nakamura and Hanafusa
/// 1986); directions below a thousandth of `least` are left out.
Eigen::Matrix3d DampedInverse(const Eigen::Matrix3d& J, double least, bool& damped) {
  const Svd svd(J);
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double sigma = svd.sigma[i];
    if (sigma < 1e-3 * least) continue;
    const double missing = 1.0 - std::min(1.0, sigma / least);
    damped |= missing > 0.0;
    inverse +=
        svd.V.col(i) * svd.U.col(i).transpose() * sigma / (sigma * sigma + missing * least * least);
  }
  return inverse;
}

int CountAbove(const Eigen::Matrix3d& J, double least) {
  return static_cast<int>((SingularValues(J).array() > least).count());
}

/// The change of the unit vector `from` on the way to `to`: across `from`, as long as the angle.
Eigen::Vector3d Toward(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = to - to.dot(from) * from;
  const double sine = across.norm();
  if (sine < 1e-12) return Eigen::Vector3d::Zero();
  return std::atan2(sine, to.dot(from)) / sine * across;
}

}  // namespace

TipJacobians TipJacobiansOf(const ShaftRodState& rod, const Eigen::Matrix3d& stiffness) {
  // dp = A dw + C df, dt = B dw + D df, df = K dp.
  const Eigen::Matrix3d C = rod.dp_RE.rightCols<3>();
  TipJacobians J;
  J.position = (Eigen::Matrix3d::Identity() - C * stiffness).inverse() * rod.dp_RE.leftCols<3>();
  J.direction = rod.end.dt.leftCols<3>() + rod.end.dt.rightCols<3>() * stiffness * J.position;
  return J;
}

Eigen::Matrix3d DirectionByRegistration(const Eigen::Matrix3d& J_tip_wrist,
                                        const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                                        const Eigen::Vector3d& d_RE) {
  // The chord c turns by w = c x dc / |c|^2, and the direction with it: dd = w x d.
  const Eigen::Vector3d c = p_RE - p_RW;
  const Eigen::Matrix3d dc = J_tip_wrist - Eigen::Matrix3d::Identity();
  return -Skew(d_RE) * Skew(c) * dc / c.squaredNorm();
}

Eigen::Vector3d DirectionController::Weighted(const Eigen::Vector3d& dp, const Eigen::Vector3d& dd,
                                              DirectionOutput& output) const {
  const double w_p = 1.0 / options_.position_tolerance_m;
  const double w_d = 1.0 / options_.direction_tolerance_rad;
  Matrix63d J;
  J << w_p * output.J.position, w_d * output.J.direction;
  Eigen::Matrix<double, 6, 1> error;
  error << w_p * dp, w_d * dd;
  // Damped where neither place nor direction moves with the wrist.
  const Eigen::Matrix3d normal = J.transpose() * J;
  const double least = w_p * options_.min_singular_value;
  const double missing = std::max(0.0, least * least - SymmetricEigenvalues(normal)[0]);
  output.damped = missing > 0.0;
  const Eigen::Matrix3d damped = normal + missing * Eigen::Matrix3d::Identity();
  return Ldlt(damped).Solve(J.transpose() * error);
}

Eigen::Vector3d DirectionController::PositionFirst(const Eigen::Vector3d& dp,
                                                   const Eigen::Vector3d& dd,
                                                   const DirectionInput& input,
                                                   DirectionOutput& output) const {
  const Eigen::Vector3d& free_axis = input.free_axis;
  Eigen::Matrix3d held = Eigen::Matrix3d::Identity();
  const bool has_free = free_axis.norm() > 0.0;
  if (has_free) held -= free_axis.normalized() * free_axis.normalized().transpose();
  const Eigen::Matrix3d J_p = held * output.J.position;
  const Eigen::Matrix3d inverse = DampedInverse(J_p, options_.min_singular_value, output.damped);
  const Eigen::Vector3d first = inverse * (held * dp);
  output.direction_freedoms = 0;
  if (!has_free) return first;
  // The one motion of the wrist that leaves the held part of the place alone.
  const Eigen::Vector3d idle = output.J.position.inverse() * free_axis.normalized();
  if (!idle.allFinite()) return first;
  const Eigen::Vector3d n = idle.normalized();
  const Eigen::Vector3d turned = output.J.direction * n;
  const double least = kFreedom / input.model.instrument.length_m;  // damped below
  const double size = turned.norm();
  output.direction_freedoms = size > least ? 1 : 0;
  output.damped |= size < least;
  const double missing = std::max(0.0, least * least - size * size);
  return first + n * turned.dot(dd - output.J.direction * first) / (size * size + missing);
}

DirectionOutput DirectionController::Step(const DirectionInput& input) {
  DirectionOutput hold;
  hold.p_RW_command = wrist_.Hold(input.p_RW);
  hold.status = ControlStatus::kBadInput;
  if (!IsPlausible(options_) || !IsPlausible(input)) return hold;
  hold.status = ControlStatus::kNoModel;
  if (!IsPlausible(input.model)) return hold;
  const ShaftRodState rod = rod_.Solve(RodOf(input.model, input.p_RW));
  if (!rod.IsUsable() || !rod.dp_RE.allFinite()) return hold;
  DirectionOutput output = hold;
  output.status = input.model.force_known ? ControlStatus::kOk : ControlStatus::kStraightInstead;
  output.J =
      TipJacobiansOf(rod, TrustedStiffness(input.model.tissue_stiffness_N_m,
                                           rod.dp_RE.rightCols<3>(), options_.max_tissue_gain));
  if (!IsFinite(output.J)) return hold;
  const Eigen::Vector3d dp = options_.gain * (input.p_RE_desired - input.p_RE);
  const Eigen::Vector3d dd =
      options_.gain * Toward(input.d_RE.normalized(), input.d_RE_desired.normalized());
  Eigen::Vector3d step;
  if (options_.priority == DirectionPriority::kWeighted) {
    step = Weighted(dp, dd, output);
    output.direction_freedoms =
        CountAbove(output.J.direction, kFreedom / input.model.instrument.length_m);
  } else {
    step = PositionFirst(dp, dd, input, output);
  }
  if (!step.allFinite()) return hold;
  const BoundedStep bounded = BoundStep(step, input.p_RW, input.model, options_.max_step_m);
  output.step_limited = bounded.limited;
  output.p_RW_command += bounded.step_m;
  output.position_left_m = (dp - output.J.position * bounded.step_m).norm();
  output.direction_left_rad = (dd - output.J.direction * bounded.step_m).norm();
  return IsFinite(output) ? output : hold;
}

}  // namespace flextip
