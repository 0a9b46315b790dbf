#include "calibration/tip/pivot.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "calibration/residual_statistics.h"
#include "calibration/tip/pivot_advice.h"
#include "calibration/tip/pivot_fit.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr std::size_t kFewestPoses = 5;
constexpr double kLeastShare = 0.6;
constexpr double kFarthest_m = 10.0;  // of a tip from its body: beyond, nothing was turned about it

/// Of the poses whose weight is not zero, and per component: all residuals, or those held out.
double Rms(const std::vector<PivotResidual>& residuals, bool heldout) {
  double sum = 0.0;
  int count = 0;
  for (const PivotResidual& r : residuals) {
    if (!r.used) continue;
    sum += (heldout ? r.heldout_R : r.r_R).squaredNorm();
    count += 3;
  }
  return count == 0 ? 0.0 : std::sqrt(sum / count);
}

/// How far each direction of B was turned: |R u - mean of R u|, rms over the poses.
void DescribeTurns(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                   PivotResult& result) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum += weights[i] * poses[i].T_RB.R;
    count += weights[i];
  }
  const Eigen::Matrix3d mean = sum / count;
  const Eigen::Matrix3d spread = Eigen::Matrix3d::Identity() - mean.transpose() * mean;
  const SymmetricEigen eigen(spread);
  result.turn_rad = eigen.values.cwiseMax(0.0).cwiseSqrt();
  result.turn_axes_B = eigen.vectors;
}

/// What noise alone makes of turn_rad: the median pose's, by the greater of stated and found.
double TurnByNoise(const std::vector<PivotPose>& poses, const PivotPoint& point) {
  std::vector<double> variances;
  variances.reserve(poses.size());
  for (const PivotPose& pose : poses)
    variances.push_back(pose.covariance.topLeftCorner<3, 3>().trace());
  return std::sqrt(2.0 / 3.0 * Median(variances) * std::max(1.0, point.orientation_factor));
}

std::string AxisText(const Eigen::Vector3d& axis) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", axis.x(), axis.y(), axis.z());
}

/// Why the tip cannot be named; empty where it can.
std::string WhatIsMissing(const PivotResult& result, const PivotOptions& options,
                          double noise_rad) {
  constexpr double kDeg = 180.0 / std::numbers::pi;
  const double limit = options.least_turn_over_noise * noise_rad;
  const std::string turned = fmt::format("{:.2f} deg rms, of which noise {:.2f} deg",
                                         kDeg * result.turn_rad[0], kDeg * noise_rad);
  if (result.turn_rad[1] < limit) return fmt::format("the poses hardly turn ({})", turned);
  const std::string axis = AxisText(result.turn_axes_B.col(0));
  if (result.turn_rad[0] < limit) {
    return fmt::format(
        "the poses turn about one axis only, {} in their own frame ({}): the tip along it is "
        "unknown",
        axis, turned);
  }
  const SymmetricEigen tip(result.covariance.topLeftCorner<3, 3>());
  const double sd_m = std::sqrt(tip.values[2]);
  if (sd_m <= options.max_sd_m) return "";
  return fmt::format(
      "the poses turn too little: the tip is known to {:.1f} mm along {} of their own frame",
      1e3 * sd_m, AxisText(tip.vectors.col(2)));
}

struct PivotSolution {
  PivotPoint point;
  std::vector<double> weights;  // 1, or 0 for an outlier
};

/// Takes outliers out until none is left or comes back.
PivotSolution FitWithoutOutliers(const std::vector<PivotPose>& poses, const PivotPoint& start,
                                 PivotNoise noise) {
  constexpr int kRounds = 15;
  const double limit = OutlierLimit(poses.size());
  PivotSolution solution{start, std::vector<double>(poses.size(), 1.0)};
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> before = solution.weights;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      solution.weights[i] = PivotSigmas(poses[i], solution.point) <= limit ? 1.0 : 0.0;
    }
    if (round > 0 && solution.weights == before) break;
    solution.point = LikelyPivot(poses, solution.weights, solution.point, noise);
  }
  return solution;
}

/// Squared error (m^2) of the poses that `counted` uses, each block of time by a fit to the others.
double BlockError(const std::vector<PivotPose>& poses, const PivotSolution& solution,
                  const PivotSolution& counted) {
  constexpr std::size_t kBlocks = 5;
  double sum = 0.0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    std::vector<double> others = solution.weights;
    const auto in_block = [&](std::size_t i) { return i * kBlocks / poses.size() == block; };
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (in_block(i)) others[i] = 0.0;
    }
    const PivotPoint point = LikelyPivot(poses, others, solution.point, PivotNoise::kKept);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (in_block(i)) sum += counted.weights[i] * PivotError(poses[i], point).squaredNorm();
    }
  }
  return sum;
}

PivotSolution FitPoses(const std::vector<PivotPose>& poses, const PivotOptions& options,
                       const PivotPoint& start, PivotResult& result) {
  constexpr double kWorse = 1.06;  // in squares
  const PivotSolution one = FitWithoutOutliers(poses, start, PivotNoise::kOneFactor);
  if (!options.separate_noise) return one;
  const PivotSolution two = FitWithoutOutliers(poses, start, PivotNoise::kTwoFactors);
  result.separate_noise = BlockError(poses, two, two) <= kWorse * BlockError(poses, one, two);
  return result.separate_noise ? two : one;
}

void DescribeResiduals(const std::vector<PivotPose>& poses, const PivotPoint& point,
                       const std::vector<double>& weights, const Matrix6d& C, PivotResult& result) {
  const double limit = OutlierLimit(poses.size());
  std::vector<Eigen::Vector3d> whitened;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    PivotResidual& r = result.residuals.emplace_back();
    r.r_R = r.heldout_R = PivotError(poses[i], point);
    r.sigmas = PivotSigmas(poses[i], point);
    r.used = weights[i] > 0.0;
    const Eigen::Matrix3d S = PivotErrorCovariance(poses[i], point);
    if (r.used) {
      Eigen::Matrix<double, 3, 6> J;
      J << poses[i].T_RB.R, -Eigen::Matrix3d::Identity();
      const Eigen::Matrix3d H = J * C * J.transpose() * S.inverse();  // its pull on itself
      r.heldout_R = Lu(Eigen::Matrix3d::Identity() - H).Solve(r.r_R);
      whitened.emplace_back(Llt(S).SolveL(r.r_R));
      ++result.used;
    } else {
      r.reason = fmt::format("{:.2f} mm off the pivot: {:.1f} sigmas; the limit is {:.1f}",
                             1e3 * r.r_R.norm(), r.sigmas, limit);
    }
  }
  result.correlation_time = CorrelationTime(whitened);
  result.rms_m = Rms(result.residuals, false);
  result.heldout_rms_m = Rms(result.residuals, true);
}

double AlgebraicRms(const std::vector<PivotPose>& poses, const PivotPoint& point) {
  double sum = 0.0;
  for (const PivotPose& pose : poses) sum += PivotError(pose, point).squaredNorm();
  return std::sqrt(sum / (3.0 * static_cast<double>(poses.size())));
}

}  // namespace

const char* Name(PivotStatus status) {
  switch (status) {
    case PivotStatus::kOk:
      return "ok";
    case PivotStatus::kTooFewPoses:
      return "too few poses";
    case PivotStatus::kUnobservable:
      return "unobservable";
    case PivotStatus::kNoPivot:
      return "no pivot";
  }
  return "";
}

PivotResult CalibratePivot(const std::vector<PivotPose>& poses, const PivotOptions& options) {
  PivotResult result;
  if (poses.size() < kFewestPoses) {
    result.unobservable = fmt::format("{} poses, expected {} at least", poses.size(), kFewestPoses);
    return result;
  }
  const PivotPoint start = AlgebraicPivot(poses, std::vector<double>(poses.size(), 1.0));
  result.algebraic_rms_m = AlgebraicRms(poses, start);
  const auto [point, weights] = FitPoses(poses, options, RobustPivot(poses, start), result);
  if (!(point.x_B.norm() < kFarthest_m)) {
    result.status = PivotStatus::kNoPivot;
    result.unobservable = fmt::format(
        "no point within {:.0f} m of the body stays in place: it was moved, and not turned about "
        "its tip",
        kFarthest_m);
    return result;
  }
  const Matrix6d H = PivotInformation(poses, weights, point);
  const Matrix6d C = CompleteOrthogonal(H).PseudoInverse();
  DescribeResiduals(poses, point, weights, C, result);
  DescribeTurns(poses, weights, result);
  result.p_BE = point.x_B;
  result.p_R = point.p_R;
  result.covariance = result.correlation_time * C;
  result.position_noise_scale = std::sqrt(point.position_factor);
  result.orientation_noise_scale = std::sqrt(point.orientation_factor);
  result.advice = AdvisePivot(poses, H / result.correlation_time,
                              result.correlation_time * PivotErrorCovariance(poses[0], point),
                              result.turn_axes_B);
  result.unobservable = WhatIsMissing(result, options, TurnByNoise(poses, point));
  result.status = result.unobservable.empty() ? PivotStatus::kOk : PivotStatus::kUnobservable;
  if (result.used < kLeastShare * static_cast<double>(poses.size())) {
    result.status = PivotStatus::kNoPivot;
    result.unobservable = fmt::format(
        "only {} of {} poses agree on a fixed point: the tip was not held, or not in one place",
        result.used, poses.size());
  }
  return result;
}

}  // namespace flextip
