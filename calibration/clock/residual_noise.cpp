#include "calibration/clock/residual_noise.h"

#include <cmath>
#include <limits>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr int kOrders[] = {0, 1, 2, 3, 4, 6, 8, 12, 16};
constexpr double kLeastKept = 0.6;  // of the samples, after the order is lost at every gap

}  // namespace

Eigen::MatrixXd Autoregression::Innovations(const Eigen::MatrixXd& columns,
                                            const std::vector<int>& before) const {
  Eigen::MatrixXd left = columns;
  const Eigen::Index n = columns.rows();
  for (Eigen::Index k = 1; k <= std::min(Order(), n - 1); ++k) {
    left.bottomRows(n - k).noalias() -= coefficients[k - 1] * columns.topRows(n - k);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (before[static_cast<std::size_t>(i)] < Order()) left.row(i).setZero();
  }
  return left;
}

Autoregression FitAutoregression(const Eigen::VectorXd& x, const std::vector<int>& before) {
  constexpr int kMost = 16;
  // Sums over the samples that the highest order has too: the criterion compares like with like.
  int most = kMost;
  const auto kept = [&](int order) {
    Eigen::Index count = 0;
    for (const int b : before) count += b >= order;
    return count;
  };
  while (most > 0 && static_cast<double>(kept(most)) < kLeastKept * static_cast<double>(x.size())) {
    most /= 2;
  }
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(most + 1, most + 1);
  Eigen::VectorXd lags(most + 1);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (before[static_cast<std::size_t>(i)] < most) continue;
    for (int k = 0; k <= most; ++k) lags[k] = x[i - k];
    sums.noalias() += lags * lags.transpose();
  }
  const double n = static_cast<double>(kept(most));
  Autoregression best;
  double least = std::numeric_limits<double>::infinity();
  for (const int order : kOrders) {
    if (order > most) break;
    Eigen::VectorXd a(order);
    double power = sums(0, 0);
    if (order > 0) {
      Eigen::MatrixXd among = sums.block(1, 1, order, order);
      among.diagonal() *= 1.0 + 1e-9;
      const Eigen::VectorXd with_past = sums.col(0).segment(1, order);
      a = Ldlt(among).Solve(with_past);
      power -= a.dot(with_past);
    }
    const double criterion = n * std::log(std::max(power, 1e-300) / n) + 2.0 * order;
    if (criterion < least && a.allFinite()) {
      least = criterion;
      best.coefficients = a;
    }
  }
  return best;
}

std::vector<int> WithoutGap(const std::vector<double>& t_s, double period_s) {
  std::vector<int> before(t_s.size(), 0);
  for (std::size_t i = 1; i < t_s.size(); ++i) {
    if (t_s[i] - t_s[i - 1] < 1.6 * period_s) before[i] = before[i - 1] + 1;
  }
  return before;
}

}  // namespace flextip
