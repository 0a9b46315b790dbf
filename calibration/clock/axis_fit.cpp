#include "calibration/clock/axis_fit.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr double kHuber = 3.0;  // standard deviations
constexpr double kFree = 1e-9;  // ridge of a free coefficient, of the largest information

double Kept(const std::vector<int>& before, Index order) {
  return static_cast<double>(
      std::count_if(before.begin(), before.end(), [&](int b) { return b >= order; }));
}

double RobustSd(const VectorXd& e, const std::vector<int>& before, Index order) {
  std::vector<double> sizes;
  for (Index i = 0; i < e.size(); ++i) {
    if (before[static_cast<std::size_t>(i)] >= order) sizes.push_back(std::abs(e[i]));
  }
  return sizes.empty() ? 1.0 : std::max(1e-15, 1.4826 * Median(sizes));
}

/// The prediction's normal equations, solved.
struct Prediction {
  MatrixXd inverse, weighted;  // of the normal matrix; weights and information times the features
  VectorXd ridge, beta, innovations;

  Prediction(const MatrixXd& x, const VectorXd& y, const Predictors& reference,
             const AxisModel& axis) {
    const VectorXd information = axis.weight / (axis.scale * axis.scale);
    weighted = information.asDiagonal() * x;
    MatrixXd normal = MatrixXd::Zero(x.cols(), x.cols());
    normal.selfadjointView<Eigen::Lower>().rankUpdate(
        (information.cwiseSqrt().asDiagonal() * x).transpose());
    ridge = VectorXd::Constant(x.cols(), kFree * normal.diagonal().maxCoeff());
    for (std::size_t g = 1; g < reference.Kinds().size(); ++g) {
      const auto& kind = reference.Kinds()[g];
      const double sd = axis.kind_sd[static_cast<Index>(g)];
      ridge.segment(kind.first, kind.count).setConstant(1.0 / (sd * sd));
    }
    normal.diagonal() += ridge;
    inverse = Ldlt<Eigen::Dynamic>(normal).Inverse();
    beta = inverse * (weighted.transpose() * y);
    innovations = y - x * beta;
  }
  /// How many coefficients are free, the small ones by their part.
  double Parameters() const {
    return static_cast<double>(beta.size()) - ridge.dot(inverse.diagonal());
  }
  /// `columns` without what the features predict of them.
  MatrixXd Own(const MatrixXd& x, const MatrixXd& columns) const {
    return columns - x * (inverse * (weighted.transpose() * columns));
  }
};

/// Sizes of the small coefficients (the evidence's fixed point; MacKay, Neural Computation 4,
/// 1992), the innovations' scale and weights.
void Learn(const Prediction& p, const Predictors& reference, const std::vector<int>& before,
           AxisModel& axis) {
  const Index order = axis.noise.Order();
  const double robust = RobustSd(p.innovations, before, order);
  axis.weight = (kHuber * robust / p.innovations.cwiseAbs().array().max(1e-15)).min(1.0);
  axis.scale = std::max(1e-15, std::sqrt(axis.weight.dot(p.innovations.cwiseAbs2()) /
                                         std::max(1.0, Kept(before, order) - p.Parameters())));
  for (std::size_t g = 1; !axis.linear && g < reference.Kinds().size(); ++g) {
    const auto& kind = reference.Kinds()[g];
    const double squares = p.beta.segment(kind.first, kind.count).squaredNorm() +
                           p.inverse.diagonal().segment(kind.first, kind.count).sum();
    axis.kind_sd[static_cast<Index>(g)] =
        std::max(1e-12, std::sqrt(squares / static_cast<double>(kind.count)));
  }
}

/// As if only the linear predictors were known: how far the clock would go.
void AddPlain(const Prediction& full, const MatrixXd& x, const MatrixXd& derivative,
              const Predictors& reference, const AxisModel& axis, ClockNormal& sum) {
  const Index first = reference.FirstSmall(), last = reference.Count();
  const Index count = last - first;
  MatrixXd fewer(x.rows(), x.cols() - count);
  fewer << x.leftCols(first), x.rightCols(x.cols() - last);
  const VectorXd told = x.middleCols(first, count) * full.beta.segment(first, count);
  VectorXd ridge(fewer.cols());
  ridge << full.ridge.head(first), full.ridge.tail(x.cols() - last);
  const VectorXd information = axis.weight / (axis.scale * axis.scale);
  const MatrixXd weighted = information.asDiagonal() * fewer;
  MatrixXd normal = fewer.transpose() * weighted;
  normal.diagonal() += ridge;
  const MatrixXd own = derivative - fewer * Ldlt<Eigen::Dynamic>(normal).Solve(
                                                MatrixXd(weighted.transpose() * derivative));
  sum.plain_normal += derivative.transpose() * (information.asDiagonal() * own);
  sum.plain_right += own.transpose() * information.cwiseProduct(told);
}

}  // namespace

VectorXd AddAxis(const ScaledRows& rows, const Predictors& reference, const VectorXd& y, bool learn,
                 bool plain, AxisModel& axis, ClockNormal& sum) {
  const MatrixXd x = axis.noise.Innovations(rows.x, rows.before);
  const VectorXd own_y = axis.noise.Innovations(y, rows.before);
  const bool fresh = axis.weight.size() != x.rows();
  if (fresh) axis.weight = VectorXd::Ones(x.rows());
  if (learn || fresh) Learn({x, own_y, reference, axis}, reference, rows.before, axis);
  const Prediction prediction(x, own_y, reference, axis);
  const VectorXd residual = y - rows.x * prediction.beta;
  MatrixXd derivative(x.rows(), 3);
  derivative.col(0) = rows.velocity * prediction.beta;
  sum.speed_squares += derivative.col(0).squaredNorm();
  derivative.col(1) = rows.since_s.cwiseProduct(derivative.col(0));
  derivative.col(2) =
      rows.by_play.rows() > 0 ? VectorXd(rows.by_play * prediction.beta) : VectorXd::Zero(x.rows());
  const MatrixXd whitened = axis.noise.Innovations(derivative, rows.before);
  const MatrixXd own = prediction.Own(x, whitened);
  const VectorXd information = axis.weight / (axis.scale * axis.scale);
  const MatrixXd score = information.cwiseProduct(prediction.innovations).asDiagonal() * own;
  if (sum.scores.rows() != x.rows()) sum.scores = MatrixXd::Zero(x.rows(), 3);
  sum.scores += score;
  sum.normal += whitened.transpose() * (information.asDiagonal() * own);
  sum.right += score.colwise().sum().transpose();
  if (plain) AddPlain(prediction, x, whitened, reference, axis, sum);
  const double kept = Kept(rows.before, axis.noise.Order());
  sum.likelihood -= 2.0 * kept * std::log(axis.scale);
  sum.kept += kept;
  sum.parameters += prediction.Parameters();
  return residual;
}

}  // namespace flextip
