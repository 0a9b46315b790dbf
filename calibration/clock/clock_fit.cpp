#include "calibration/clock/clock_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/clock/axis_fit.h"
#include "core/linear_algebra.h"

namespace flextip {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kRateSd = 3e-4;    // of quartz and of computers that set their clocks
constexpr double kPlaySd_m = 2e-3;  // of play in a drive
constexpr int kTurning = 2, kWhitening = 3, kLearning = 9, kMostSteps = 30, kQuickSteps = 5;
constexpr double kStill_s = 1e-7, kStillRate = 1e-9, kStill_m = 1e-7, kStillPart = 0.003;
constexpr double kLongestStep_s = 0.1, kLongestStep_m = 5e-4, kWidest_m = 6e-3;
constexpr Index kLeastRows = 40;
constexpr double kBlock_s = 1.0;
// The model's own error, as parts of how far play and the small predictors move the clock, and of
// the time in which the motion makes the residual: much of it where forces are predicted by motion,
// a little, without its noise, where a load of its own moves the tip; and at least.
constexpr double kPlayPart = 0.03, kSmallPart = 0.2, kForcePart = 0.7, kMotionPart = 0.02,
                 kLeast_s = 2e-5;

/// The features over their sizes, with a constant.
MatrixXd Scaled(const MatrixXd& x, const VectorXd& size, double constant) {
  MatrixXd z(x.rows(), x.cols() + 1);
  z.leftCols(x.cols()) = x.array().rowwise() / size.transpose().array();
  z.col(x.cols()).setConstant(constant);
  return z;
}

/// The sum over blocks of time of the products of their scores.
MatrixXd ScoreScatter(const ClockRows& rows, const MatrixXd& scores, Index count) {
  MatrixXd scatter = MatrixXd::Zero(count, count);
  VectorXd block = VectorXd::Zero(count);
  double end_s = rows.t_s.front() + kBlock_s;
  for (std::size_t i = 0; i < rows.t_s.size(); ++i) {
    if (rows.t_s[i] >= end_s) {
      scatter += block * block.transpose();
      block.setZero();
      end_s = rows.t_s[i] + kBlock_s;
    }
    block += scores.row(static_cast<Index>(i)).head(count).transpose();
  }
  return scatter + block * block.transpose();
}

/// Gauss-Newton with all that is learnt on the way.
class Fit {
 public:
  Fit(const Motion& target, Predictors& reference, double origin_s, bool linear)
      : target_(target), reference_(reference), origin_s_(origin_s), linear_(linear) {}

  /// Goes at most so many steps and learns in the first of them; tells whether it came to rest.
  bool Go(ClockPoint& point, bool free_play, int steps, int learning);
  ClockFit Result(const ClockPoint& point, bool free_play);
  std::size_t Samples() const { return rows_.t_s.size(); }
  double Brought() const { return Likelihood() - LikelihoodAlone(); }
  /// Twice the log likelihood of an innovation.
  double Likelihood() const { return normal_.likelihood / std::max(1.0, normal_.kept); }

 private:
  bool Linearise(const ClockPoint& point, bool free_play, bool learn, bool plain);
  void Begin();
  Eigen::Vector3d Change(const ClockPoint& point, bool free_play) const;
  double ModelSd(const ClockPoint& point, bool free_play, const MatrixXd& inverse) const;
  double RememberedNorm() const;
  double LikelihoodAlone() const;

  const Motion& target_;
  Predictors& reference_;
  double origin_s_;
  bool linear_;  // the small predictors stay out
  int learnt_steps_ = 0;
  ClockRows rows_;
  VectorXd middle_, size_;  // of the features
  MatrixXd axes_;           // orthonormal columns: the principal axes of the residual
  std::vector<AxisModel> axis_;
  MatrixXd residual_;
  double speed_ = 0.0;  // norm of the prediction's derivative by the offset
  ClockNormal normal_;
};

void Fit::Begin() {
  const double root = std::sqrt(static_cast<double>(rows_.Count()));
  middle_ = rows_.x.colwise().mean().transpose();
  size_ = ((rows_.x.rowwise() - middle_.transpose()).colwise().norm() / root)
              .transpose()
              .cwiseMax(1e-12);
  axes_ = MatrixXd::Identity(target_.own_rows, target_.own_rows);
  for (Index a = 0; a < target_.own_rows; ++a) {
    const VectorXd y = rows_.y.col(a).array() - rows_.y.col(a).mean();
    const double sd = std::max(1e-12, y.norm() / root);
    AxisModel axis{.scale = 0.1 * sd, .linear = linear_};
    axis.kind_sd = VectorXd::Constant(static_cast<Index>(reference_.Kinds().size()),
                                      (linear_ ? 1e-9 : 0.02) * sd);
    axis_.push_back(axis);
  }
}

bool Fit::Linearise(const ClockPoint& point, bool free_play, bool learn, bool plain) {
  rows_ = GatherRows(target_, reference_, point, origin_s_, free_play);
  if (rows_.Count() < kLeastRows) return false;
  if (axis_.empty()) Begin();
  const ScaledRows scaled{Scaled(rows_.x.rowwise() - middle_.transpose(), size_, 1.0),
                          Scaled(rows_.velocity, size_, 0.0),
                          free_play ? Scaled(rows_.by_play, size_, 0.0) : MatrixXd(), rows_.since_s,
                          rows_.before};
  normal_ = {};
  residual_.resize(rows_.Count(), target_.own_rows);
  const MatrixXd y = rows_.y * axes_;
  for (Index a = 0; a < target_.own_rows; ++a) {
    AxisModel& axis = axis_[static_cast<std::size_t>(a)];
    residual_.col(a) = AddAxis(scaled, reference_, y.col(a), learn, plain, axis, normal_);
    if (learn && learnt_steps_ >= kWhitening) {
      axis.noise = FitAutoregression(residual_.col(a), rows_.before);
    }
  }
  if (learn && learnt_steps_++ == kTurning) {  // what disturbs along one axis is whitened there
    axes_ = axes_ * SymmetricEigen(MatrixXd(residual_.transpose() * residual_)).vectors;
  }
  speed_ = std::sqrt(normal_.speed_squares);
  normal_.normal(1, 1) += 1.0 / (kRateSd * kRateSd);
  normal_.right[1] -= point[1] / (kRateSd * kRateSd);
  normal_.normal(2, 2) += 1.0 / (kPlaySd_m * kPlaySd_m);
  normal_.right[2] -= point[2] / (kPlaySd_m * kPlaySd_m);
  return true;
}

Eigen::Vector3d Fit::Change(const ClockPoint& point, bool free_play) const {
  Eigen::Vector3d change = Ldlt<3>(normal_.normal).Solve(normal_.right);
  if (!free_play || (point[2] <= 0.0 && change[2] < 0.0)) {  // held, or at its end
    change.head<2>() = Ldlt<2>(Eigen::Matrix2d(normal_.normal.topLeftCorner<2, 2>()))
                           .Solve(Eigen::Vector2d(normal_.right.head<2>()));
    change[2] = 0.0;
  }
  change[0] = std::clamp(change[0], -kLongestStep_s, kLongestStep_s);
  change[2] = std::clamp(change[2], -kLongestStep_m, kLongestStep_m);
  return change;
}

bool Fit::Go(ClockPoint& point, bool free_play, int steps, int learning) {
  for (int step = 0; step < steps; ++step) {
    if (!Linearise(point, free_play, step < learning, false)) return false;
    Eigen::Vector3d change = Change(point, free_play);
    if (!change.allFinite()) return false;
    // Slow motion tells little: then it is enough to be still beside the deviation.
    const auto still = [&](Index i, double least) {
      return std::abs(change[i]) < std::max(least, kStillPart / std::sqrt(normal_.normal(i, i)));
    };
    if (step >= learning && still(0, kStill_s) && still(1, kStillRate) && still(2, kStill_m)) {
      return true;
    }
    if (step > kMostSteps / 2) change *= 0.5;  // samples that come and go at the ends
    point += change;
    point[1] = std::clamp(point[1], -0.01, 0.01);
    point[2] = std::clamp(point[2], 0.0, kWidest_m);
  }
  return false;
}

/// What the model may be off by: parts of how far the clock would go without play, or with the
/// linear predictors alone.
double Fit::ModelSd(const ClockPoint& point, bool free_play, const MatrixXd& inverse) const {
  double play_s = 0.0, small_s = 0.0;
  if (free_play) {
    play_s = point[2] * inverse(0, 2) / inverse(2, 2);
    small_s = Ldlt<2>(Eigen::Matrix2d(normal_.plain_normal.topLeftCorner<2, 2>()))
                  .Solve(Eigen::Vector2d(normal_.plain_right.head<2>()))[0];
  }
  // Friction and soft tissue rule a force, and little of them is known.
  const bool alike = target_.is_force == reference_.IsForce();
  const double moved = alike ? kMotionPart * RememberedNorm() : kForcePart * residual_.norm();
  return std::hypot(std::hypot(kPlayPart * play_s, kSmallPart * small_s),
                    moved / std::max(1e-300, speed_), kLeast_s);
}

/// Returns the norm of what the residual has from its own past: what moves on its own, without the
/// noise of single samples.
double Fit::RememberedNorm() const {
  double square = 0.0;
  for (Index a = 0; a < target_.own_rows; ++a) {
    const Autoregression& past = axis_[static_cast<std::size_t>(a)].noise;
    double whole = 0.0;  // of the rows that have an innovation
    for (Index i = 0; i < residual_.rows(); ++i)
      if (rows_.before[static_cast<std::size_t>(i)] >= past.Order())
        whole += residual_(i, a) * residual_(i, a);
    const double new_square = past.Innovations(residual_.col(a), rows_.before).squaredNorm();
    square += std::max(0.0, whole - new_square);
  }
  return std::sqrt(square);
}

/// As Likelihood, of the target alone: each axis by its own past.
double Fit::LikelihoodAlone() const {
  const MatrixXd y = (rows_.y.rowwise() - rows_.y.colwise().mean()) * axes_;
  double sum = 0.0, count = 0.0;
  for (Index a = 0; a < y.cols(); ++a) {
    const Autoregression past = FitAutoregression(y.col(a), rows_.before);
    const double kept = static_cast<double>(std::count_if(
        rows_.before.begin(), rows_.before.end(), [&](int b) { return b >= past.Order(); }));
    const double power = past.Innovations(y.col(a), rows_.before).squaredNorm();
    sum -= kept * std::log(std::max(1e-30, power / std::max(1.0, kept)));
    count += kept;
  }
  return sum / std::max(1.0, count);
}

ClockFit Fit::Result(const ClockPoint& point, bool free_play) {
  Linearise(point, free_play, false, free_play);
  ClockFit fit{.offset_s = point[0], .rate = point[1], .origin_s = origin_s_, .play_m = point[2]};
  const Index free = free_play ? 3 : 2;
  const MatrixXd inverse = Ldlt(MatrixXd(normal_.normal.topLeftCorner(free, free))).Inverse();
  MatrixXd scatter = ScoreScatter(rows_, normal_.scores, free);
  scatter(1, 1) += 1.0 / (kRateSd * kRateSd);
  if (free_play) scatter(2, 2) += 1.0 / (kPlaySd_m * kPlaySd_m);
  const MatrixXd by_blocks = inverse * scatter * inverse;
  Eigen::Vector2d larger;
  for (Index i = 0; i < 2; ++i) {
    larger[i] = std::sqrt(std::max(1.0, by_blocks(i, i) / inverse(i, i)));
  }
  fit.covariance = larger.asDiagonal() * inverse.topLeftCorner<2, 2>() * larger.asDiagonal();
  const double model_s = ModelSd(point, free_play, inverse);
  fit.covariance(0, 0) += model_s * model_s;
  fit.samples = rows_.t_s.size();
  const MatrixXd y = rows_.y.rowwise() - rows_.y.colwise().mean();
  fit.misfit = std::min(1.0, residual_.squaredNorm() / std::max(1e-300, y.squaredNorm()));
  fit.likelihood = Likelihood();
  fit.brought = Brought();
  fit.parameters = normal_.parameters;
  fit.converged = fit.covariance.allFinite();
  return fit;
}

/// The middle of the overlap; NaN where it is too short.
double Origin(const Motion& target, Predictors& reference, double offset_s) {
  const ClockRows rows = GatherRows(target, reference, {offset_s, 0.0, 0.0}, 0.0, false);
  return rows.Count() < kLeastRows ? std::numeric_limits<double>::quiet_NaN()
                                   : 0.5 * (rows.t_s.front() + rows.t_s.back());
}

}  // namespace

ClockFit QuickFit(const Motion& target, Predictors& reference, double offset_s, double play_m,
                  bool linear) {
  ClockFit quick{.offset_s = offset_s, .play_m = play_m};
  quick.origin_s = Origin(target, reference, offset_s);
  if (std::isnan(quick.origin_s)) return quick;
  ClockPoint point(offset_s, 0.0, play_m);
  Fit fit(target, reference, quick.origin_s, linear);
  fit.Go(point, false, kQuickSteps, kQuickSteps);
  quick.offset_s = point[0];
  quick.rate = point[1];
  quick.samples = fit.Samples();
  if (quick.samples == 0) return quick;
  quick.likelihood = fit.Likelihood();
  quick.brought = fit.Brought();
  quick.converged = std::isfinite(quick.likelihood);
  return quick;
}

ClockFit FitClock(const Motion& target, Predictors& reference, double start_offset_s) {
  ClockFit none{.offset_s = start_offset_s};
  none.origin_s = Origin(target, reference, start_offset_s);
  if (std::isnan(none.origin_s)) return none;
  ClockPoint best(start_offset_s, 0.0, 0.0);
  const bool has_play = reference.HasPlay();
  if (has_play) {
    double most = -std::numeric_limits<double>::infinity();
    for (const double play_m : {0.0, 5e-4, 1.2e-3, 2.4e-3}) {
      const ClockFit quick = QuickFit(target, reference, start_offset_s, play_m, false);
      if (!quick.converged || quick.likelihood <= most) continue;
      most = quick.likelihood;
      best = ClockPoint(quick.offset_s, quick.rate, play_m);
    }
  }
  Fit fit(target, reference, none.origin_s, false);
  return fit.Go(best, has_play, kMostSteps, kLearning) ? fit.Result(best, has_play) : none;
}

}  // namespace flextip
