#include "calibration/clock/smooth_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kReach = 3.0;        // bandwidths
constexpr double kKnots = 0.5;        // bandwidths between knots
constexpr int kLeastSamples = 4;      // of a fit
constexpr double kShortest_s = 0.03;  // hands and arms move below 3 Hz

}  // namespace

double UsualBandwidth(const Motion& motion) {
  return std::max(kShortest_s, 2.5 * motion.PeriodSeconds());
}

SmoothMotion::SmoothMotion(const Motion& motion, double bandwidth_s)
    : step_s_(kKnots * bandwidth_s) {
  if (motion.Count() < 2) return;
  first_s_ = motion.t_s.front();
  const double span_s = motion.t_s.back() - first_s_;
  const auto knots = static_cast<Eigen::Index>(std::floor(span_s / step_s_)) + 1;
  values_.resize(motion.values.rows(), knots);
  slopes_.resize(motion.values.rows(), knots);
  std::size_t from = 0;
  for (Eigen::Index k = 0; k < knots; ++k) {
    known_.push_back(
        Fit(motion, bandwidth_s, first_s_ + step_s_ * static_cast<double>(k), from, k));
  }
}

bool SmoothMotion::Fit(const Motion& motion, double bandwidth_s, double t_s, std::size_t& from,
                       Eigen::Index knot) {
  while (motion.t_s[from] < t_s - kReach * bandwidth_s) ++from;
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(3, motion.values.rows());
  int count = 0;
  bool before = false, after = false;  // a sample near by on each side
  for (std::size_t i = from; i < motion.Count(); ++i) {
    const double u = (motion.t_s[i] - t_s) / bandwidth_s;
    if (u > kReach) break;
    const Eigen::Vector3d powers(1.0, u, u * u);
    const double weight = std::exp(-0.5 * u * u);
    sums += weight * powers * powers.transpose();
    moments += weight * powers * motion.values.col(static_cast<Eigen::Index>(i)).transpose();
    before = before || (u <= 0.0 && u > -1.5);
    after = after || (u >= 0.0 && u < 1.5);
    ++count;
  }
  const Ldlt ldlt(sums);
  if (count < kLeastSamples || !before || !after || !(ldlt.Pivots().minCoeff() > 1e-9)) {
    return false;
  }
  const Eigen::MatrixXd powers = ldlt.Solve(moments);
  values_.col(knot) = powers.row(0).transpose();
  slopes_.col(knot) = powers.row(1).transpose() / bandwidth_s;
  return true;
}

double SmoothMotion::EndSeconds() const {
  return first_s_ + step_s_ * static_cast<double>(std::max<Eigen::Index>(values_.cols(), 1) - 1);
}

bool SmoothMotion::At(double t_s, Eigen::VectorXd& value, Eigen::VectorXd& velocity) const {
  const double knot = (t_s - first_s_) / step_s_;
  if (!(knot >= 0.0) || knot >= static_cast<double>(values_.cols() - 1)) return false;
  const auto k = static_cast<Eigen::Index>(knot);
  if (!known_[static_cast<std::size_t>(k)] || !known_[static_cast<std::size_t>(k) + 1]) {
    return false;
  }
  const double u = knot - static_cast<double>(k), v = 1.0 - u;
  const auto a = values_.col(k), b = values_.col(k + 1);
  const auto da = slopes_.col(k), db = slopes_.col(k + 1);
  value = v * v * (1.0 + 2.0 * u) * a + u * u * (3.0 - 2.0 * u) * b +
          step_s_ * u * v * (v * da - u * db);
  velocity = 6.0 * u * v / step_s_ * (b - a) + v * (1.0 - 3.0 * u) * da + u * (3.0 * u - 2.0) * db;
  return true;
}

double SmoothMotion::SpeedAt(double t_s, int rows) const {
  Eigen::VectorXd value, velocity;
  if (!At(t_s, value, velocity)) return std::numeric_limits<double>::quiet_NaN();
  return velocity.head(rows).norm();
}

}  // namespace flextip
