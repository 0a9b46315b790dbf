#include "diagnosis/half_normal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip {
namespace {

constexpr double kFarOut = -12.0;  // from here on the asymptotic series is exact enough
const double kLogRoot2Pi = 0.5 * std::log(2.0 * std::numbers::pi);

/// The normal vector given that component `i` is positive, with the moments it then has.
void Truncate(int i, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
  const double variance = covariance(i, i), sd = std::sqrt(variance), a = mean[i] / sd;
  // phi(a) / Phi(a)
  const double mills = std::exp(-0.5 * a * a - kLogRoot2Pi - LogPhi(a));
  const double shift = sd * mills;
  // Far out the bracket is the difference of nearly equal numbers: 1 / a^2 there.
  const double left = a < -1e3 ? 1.0 / (a * a) : std::max(0.0, 1.0 - mills * (mills + a));
  const Eigen::VectorXd along = covariance.col(i) / variance;
  mean += along * shift;
  covariance -= (1.0 - left) * variance * along * along.transpose();
}

}  // namespace

double LogPhi(double x) {
  if (x > kFarOut) return std::log(0.5 * std::erfc(-x / std::numbers::sqrt2));
  const double inverse = 1.0 / (x * x);
  double series = 1.0, term = 1.0;
  for (int n = 1; n <= 8; ++n) series += term *= -(2.0 * n - 1.0) * inverse;
  return -0.5 * x * x - std::log(-x) - kLogRoot2Pi + std::log(series);
}

double LogPositive(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                   const std::vector<int>& positive) {
  Eigen::VectorXd m = mean;
  Eigen::MatrixXd C = covariance;
  std::vector<int> left = positive;
  double log_probability = 0.0;
  while (!left.empty()) {
    const auto in_sd = [&](int i) { return m[i] / std::sqrt(C(i, i)); };
    const auto least = std::min_element(left.begin(), left.end(),
                                        [&](int a, int b) { return in_sd(a) < in_sd(b); });
    log_probability += LogPhi(in_sd(*least));
    const int taken = *least;
    left.erase(least);
    if (!left.empty()) Truncate(taken, m, C);
  }
  return log_probability;
}

Eigen::VectorXd PositiveMode(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             const std::vector<int>& positive) {
  Eigen::VectorXd mode = mean;
  std::vector<int> at_zero;
  for (std::size_t pass = 0; pass <= positive.size(); ++pass) {
    const auto before = at_zero.size();
    for (const int i : positive)
      if (mode[i] < 0.0 && std::find(at_zero.begin(), at_zero.end(), i) == at_zero.end())
        at_zero.push_back(i);
    if (at_zero.size() == before) break;
    const Eigen::MatrixXd C = covariance(at_zero, at_zero);
    const Eigen::VectorXd pull = C.llt().solve(Eigen::VectorXd(mean(at_zero)));
    mode = mean - covariance(Eigen::all, at_zero) * pull;
    for (const int i : at_zero) mode[i] = 0.0;
  }
  return mode;
}

}  // namespace flextip
