#include "calibration/clock/clock_fit.h"

#include <algorithm>
#include <cmath>

#include "calibration/residual_statistics.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr double kRateSd = 3e-4;  // of quartz and of computers that set their clocks
constexpr double kHuber = 2.5;    // standard deviations
constexpr int kMostSteps = 30;
constexpr double kStill_s = 1e-7, kStillRate = 1e-9;
constexpr double kLongestStep_s = 0.2;

// A target has at most 4 rows, a reference 6 and a constant.
constexpr int kRows = 4, kFeatures = 7, kUnknowns = 2 + kRows * kFeatures;
using Features = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kFeatures, 1>;
using Values = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kRows, 1>;
using Mixing = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kRows, kRows>;
using Predicting = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kRows, kFeatures>;
using Derivative = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kRows, kUnknowns>;

/// The samples that both streams have at the present clock, in rows of the linear problem.
struct Rows {
  std::vector<Features> x, velocity;  // predicting values with a constant; their velocity
  std::vector<Values> y;
  std::vector<double> since_origin_s;
  std::vector<std::size_t> sample;
};

class Problem {
 public:
  Problem(const Motion& target, const SmoothMotion& reference)
      : target_(target), reference_(reference), rows_(target.own_rows) {}

  Rows At(double offset_s, double rate, double origin_s) const {
    Rows rows;
    Eigen::VectorXd x, velocity;
    for (std::size_t i = 0; i < target_.Count(); ++i) {
      const double since_s = target_.t_s[i] - origin_s;
      if (!reference_.At(target_.t_s[i] + offset_s + rate * since_s, x, velocity)) continue;
      Features with_constant(x.size() + 1), without(x.size() + 1);
      with_constant << x, 1.0;
      without << velocity, 0.0;
      rows.x.push_back(with_constant);
      rows.velocity.push_back(without);
      rows.y.emplace_back(target_.values.col(static_cast<Eigen::Index>(i)).head(rows_));
      rows.since_origin_s.push_back(since_s);
      rows.sample.push_back(i);
    }
    return rows;
  }

  template <class T>
  T Whitened(std::size_t sample, const T& v) const {
    if (target_.whitening.empty()) return v;
    return target_.whitening[sample] * v;
  }
  int OwnRows() const { return rows_; }

 private:
  const Motion& target_;
  const SmoothMotion& reference_;
  int rows_;
};

/// Features shifted and scaled to mean 0 and size 1, so that one ridge fits all.
struct Scale {
  Features mean, size;

  explicit Scale(const Rows& rows) {
    const Eigen::Index n = rows.x.front().size();
    const double count = static_cast<double>(rows.x.size());
    mean = Features::Zero(n);
    size = Features::Zero(n);
    for (const auto& x : rows.x) mean += x / count;
    mean[n - 1] = 0.0;
    for (const auto& x : rows.x) size += (x - mean).cwiseAbs2() / count;
    size = size.cwiseSqrt().cwiseMax(1e-12);
  }
  Features Of(const Features& x) const { return (x - mean).cwiseQuotient(size); }
};

/// One linearisation: the normal equations of (offset, rate, prediction) and the residuals.
struct Linear {
  Eigen::MatrixXd normal;  // J^T W J with priors
  Eigen::VectorXd right;   // J^T W r
  std::vector<Derivative> J;
  std::vector<Values> r;  // whitened
  std::vector<double> weight;
  double scale = 1.0;  // standard deviation of a whitened component
  double misfit = 1.0;
};

/// The prediction (own rows x features) that fits the present clock best.
Predicting Prediction(const Problem& problem, const Rows& rows, const Scale& scale,
                      const std::vector<double>& weight) {
  const Eigen::Index features = scale.mean.size(), own = problem.OwnRows();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(own * features, own * features);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(own * features);
  for (std::size_t i = 0; i < rows.x.size(); ++i) {
    const Features x = scale.Of(rows.x[i]);
    const Mixing root = problem.Whitened(rows.sample[i], Mixing(Mixing::Identity(own, own)));
    const Mixing information = weight[i] * root.transpose() * root;
    const Values told = information * rows.y[i];
    for (Eigen::Index a = 0; a < own; ++a) {
      right.segment(a * features, features) += told[a] * x;
      for (Eigen::Index b = 0; b < own; ++b) {
        if (information(a, b) == 0.0) continue;
        normal.block(a * features, b * features, features, features).noalias() +=
            information(a, b) * x * x.transpose();
      }
    }
  }
  normal.diagonal() *= 1.0 + 1e-9;
  const Eigen::VectorXd solution = Ldlt(normal).Solve(right);
  return Eigen::Map<const Eigen::MatrixXd>(solution.data(), features, own).transpose();
}

Linear Linearise(const Problem& problem, const Rows& rows, double rate) {
  const Scale scale(rows);
  const std::size_t n = rows.x.size();
  const Eigen::Index features = scale.mean.size(), own = problem.OwnRows();
  Linear linear;
  linear.weight.assign(n, 1.0);
  Predicting prediction;
  for (int pass = 0; pass < 3; ++pass) {  // Huber's weights by the residuals
    prediction = Prediction(problem, rows, scale, linear.weight);
    linear.r.clear();
    std::vector<double> lengths;
    for (std::size_t i = 0; i < n; ++i) {
      const Values r = rows.y[i] - prediction * scale.Of(rows.x[i]);
      linear.r.push_back(problem.Whitened(rows.sample[i], r));
      lengths.push_back(linear.r.back().norm());
    }
    linear.scale = std::max(1e-15, RobustScale(lengths));
    const double limit = kHuber * std::sqrt(static_cast<double>(own)) * linear.scale;
    for (std::size_t i = 0; i < n; ++i) linear.weight[i] = std::min(1.0, limit / lengths[i]);
  }
  const Eigen::Index unknowns = 2 + own * features;
  linear.normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  linear.right = Eigen::VectorXd::Zero(unknowns);
  Values mean = Values::Zero(own);
  for (const auto& y : rows.y) mean += y / static_cast<double>(n);
  double left = 0.0, all = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    Derivative J = Derivative::Zero(own, unknowns);
    J.col(0) = prediction * rows.velocity[i].cwiseQuotient(scale.size);
    J.col(1) = rows.since_origin_s[i] * J.col(0);
    const Features x = scale.Of(rows.x[i]);
    for (Eigen::Index a = 0; a < own; ++a)
      J.block(a, 2 + a * features, 1, features) = x.transpose();
    J = problem.Whitened(rows.sample[i], J);
    linear.normal.noalias() += linear.weight[i] * J.transpose() * J;
    linear.right.noalias() += linear.weight[i] * J.transpose() * linear.r[i];
    linear.J.push_back(std::move(J));
    left += linear.weight[i] * linear.r[i].squaredNorm();
    all +=
        linear.weight[i] * problem.Whitened(rows.sample[i], Values(rows.y[i] - mean)).squaredNorm();
  }
  linear.misfit = all > 0.0 ? std::min(1.0, left / all) : 1.0;
  const double prior = linear.scale * linear.scale / (kRateSd * kRateSd);
  linear.normal(1, 1) += prior;
  linear.right[1] -= prior * rate;
  linear.normal.diagonal().tail(own * features) *= 1.0 + 1e-9;
  return linear;
}

/// The autocorrelation of the residuals from lag 0 to where it is within chance.
std::vector<double> Autocorrelation(const Linear& linear) {
  const std::size_t n = linear.r.size();
  const double chance = 2.0 / std::sqrt(static_cast<double>(n * linear.r.front().size()));
  std::vector<double> correlation;
  double power = 0.0;
  for (std::size_t lag = 0; lag < std::max<std::size_t>(1, n / 4); ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) {
      sum += linear.weight[i] * linear.weight[i - lag] * linear.r[i].dot(linear.r[i - lag]);
    }
    if (lag == 0) power = sum;
    if (lag > 0 && !(sum > chance * power)) break;
    correlation.push_back(power > 0.0 ? sum / power : 1.0);
  }
  return correlation;
}

/// The covariance of (offset, rate) under residuals of that autocorrelation.
Eigen::Matrix2d Covariance(const Linear& linear, const std::vector<double>& correlation) {
  using Part = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kRows>;
  const Eigen::MatrixXd inverse = Ldlt(linear.normal).Inverse();
  const Eigen::MatrixXd by_score = inverse.topRows(2);
  const std::size_t n = linear.r.size();
  std::vector<Part> part;
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    part.emplace_back(linear.weight[i] * by_score * linear.J[i].transpose());
    squares += linear.weight[i] * linear.r[i].squaredNorm();
  }
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < correlation.size(); ++k) {
    Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
    for (std::size_t i = k; i < n; ++i) products += part[i] * part[i - k].transpose();
    sum += correlation[k] * (k == 0 ? products : Eigen::Matrix2d(products + products.transpose()));
  }
  const double rows = static_cast<double>(n * linear.r.front().size());
  const double unknowns = static_cast<double>(linear.normal.rows());
  sum *= squares / std::max(1.0, rows - unknowns);
  const double prior = linear.scale * linear.scale / kRateSd;
  const Eigen::Vector2d by_prior = inverse.block<2, 1>(0, 1);
  return sum + prior * prior * by_prior * by_prior.transpose();
}

/// How many residuals one independent residual stands for.
double Memory(const std::vector<double>& correlation) {
  double memory = -1.0;
  for (const double c : correlation) memory += 2.0 * c;
  return memory;
}

}  // namespace

ClockFit FitClock(const Motion& target, const SmoothMotion& reference, double start_offset_s) {
  const Problem problem(target, reference);
  ClockFit fit{.offset_s = start_offset_s};
  const Rows first = problem.At(start_offset_s, 0.0, 0.0);
  if (first.sample.size() < 20) return fit;
  fit.origin_s = 0.5 * (target.t_s[first.sample.front()] + target.t_s[first.sample.back()]);
  for (int step = 0; step < kMostSteps; ++step) {
    const Rows rows = problem.At(fit.offset_s, fit.rate, fit.origin_s);
    if (rows.sample.size() < 20) return fit;
    const Linear linear = Linearise(problem, rows, fit.rate);
    const Eigen::VectorXd change = Ldlt(linear.normal).Solve(linear.right);
    if (!change.allFinite()) return fit;
    fit.misfit = linear.misfit;
    if (std::abs(change[0]) < kStill_s && std::abs(change[1]) < kStillRate) {
      const std::vector<double> correlation = Autocorrelation(linear);
      fit.covariance = Covariance(linear, correlation);
      fit.samples = rows.sample.size();
      fit.independent = static_cast<double>(fit.samples) * target.own_rows / Memory(correlation);
      fit.converged = fit.covariance.allFinite();
      return fit;
    }
    fit.offset_s += std::clamp(change[0], -kLongestStep_s, kLongestStep_s);
    fit.rate = std::clamp(fit.rate + change[1], -0.01, 0.01);
  }
  return fit;
}

}  // namespace flextip
