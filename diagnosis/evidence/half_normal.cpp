#include "diagnosis/evidence/half_normal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kFewPositive = 10;  // so many are all tried, at zero or free

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

/// The mode with the parameters of `at_zero` held there, and what holds them.
Eigen::VectorXd ModeHeld(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                         const std::vector<int>& at_zero, Eigen::VectorXd& pull) {
  pull = Llt(Eigen::MatrixXd(covariance(at_zero, at_zero))).Solve(Eigen::VectorXd(mean(at_zero)));
  Eigen::VectorXd mode = mean - covariance(Eigen::all, at_zero) * pull;
  for (const int i : at_zero) mode[i] = 0.0;
  return mode;
}

/// By an active set (Lawson & Hanson 1974): the most negative is held, who is held against its will
/// is freed.
Eigen::VectorXd PositiveModeOfMany(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                                   const std::vector<int>& positive) {
  std::vector<int> at_zero;
  Eigen::VectorXd mode = mean, pull;
  for (std::size_t step = 0; step < 4 * positive.size(); ++step) {
    int worst = -1;
    for (const int i : positive)
      if (mode[i] < 0.0 && (worst < 0 || mode[i] / std::sqrt(covariance(i, i)) <
                                             mode[worst] / std::sqrt(covariance(worst, worst))))
        worst = i;
    if (worst >= 0) {
      at_zero.push_back(worst);
    } else {
      // A held one whose pull is upwards would rather be positive.
      std::size_t freed = at_zero.size();
      for (std::size_t i = 0; i < at_zero.size(); ++i)
        if (pull[Eigen::Index(i)] > 0.0) freed = i;
      if (freed == at_zero.size()) return mode;
      at_zero.erase(at_zero.begin() + std::ptrdiff_t(freed));
    }
    if (at_zero.empty()) return mean;
    mode = ModeHeld(mean, covariance, at_zero, pull);
  }
  for (const int i : positive) mode[i] = std::max(0.0, mode[i]);
  return mode;
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
  if (positive.size() > kFewPositive) return PositiveModeOfMany(mean, covariance, positive);
  Eigen::VectorXd best = mean;
  double least = std::numeric_limits<double>::infinity();
  // Each may be at zero or free: few enough to try them all.
  for (unsigned set = 0; set < 1U << positive.size(); ++set) {
    std::vector<int> at_zero;
    for (std::size_t i = 0; i < positive.size(); ++i)
      if ((set >> i & 1U) != 0) at_zero.push_back(positive[i]);
    const Eigen::VectorXd off = mean(at_zero);
    const Eigen::VectorXd pull = Llt(Eigen::MatrixXd(covariance(at_zero, at_zero))).Solve(off);
    Eigen::VectorXd mode = mean - covariance(Eigen::all, at_zero) * pull;
    for (const int i : at_zero) mode[i] = 0.0;
    const bool allowed =
        std::all_of(positive.begin(), positive.end(), [&](int i) { return mode[i] >= 0.0; });
    if (!allowed || off.dot(pull) >= least) continue;
    least = off.dot(pull);
    best = mode;
  }
  return best;
}

}  // namespace flextip::diagnosis
