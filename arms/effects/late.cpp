#include "arms/effects/late.h"

#include <algorithm>
#include <cmath>

namespace flextip::arms {

Eigen::VectorXd Slopes(const Eigen::VectorXd& t, const Eigen::VectorXd& x) {
  const Eigen::Index n = x.size();
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index a = std::max<Eigen::Index>(0, k - 1), b = std::min(n - 1, k + 1);
    if (b > a) slope[k] = (x[b] - x[a]) / (t[b] - t[a]);
  }
  return slope;
}

Eigen::VectorXd Delayed(const Eigen::VectorXd& t, const Eigen::VectorXd& x, double delay_s) {
  const Eigen::Index n = x.size();
  const Eigen::VectorXd slope = Slopes(t, x);
  Eigen::VectorXd late = x;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double at = t[k] - delay_s;
    if (at <= t[0] || at >= t[n - 1]) {
      late[k] = at <= t[0] ? x[0] : x[n - 1];
      continue;
    }
    const Eigen::Index i = std::upper_bound(t.begin(), t.end(), at) - t.begin() - 1;
    const double h = t[i + 1] - t[i], u = (at - t[i]) / h, u2 = u * u, u3 = u2 * u;
    late[k] = (2 * u3 - 3 * u2 + 1) * x[i] + (u3 - 2 * u2 + u) * h * slope[i] +
              (-2 * u3 + 3 * u2) * x[i + 1] + (u3 - u2) * h * slope[i + 1];
  }
  return late;
}

Eigen::VectorXd Lagged(const Eigen::VectorXd& t, const Eigen::VectorXd& x, double time_s) {
  const Eigen::VectorXd slopes = Slopes(t, x);
  if (time_s <= 0.0) return x - time_s * slopes;
  Eigen::VectorXd lagged = x;
  double behind = -time_s * slopes[0];
  lagged[0] += behind;
  for (Eigen::Index k = 1; k < x.size(); ++k) {
    const double h = t[k] - t[k - 1], slope = (x[k] - x[k - 1]) / h, a = std::exp(-h / time_s);
    behind = -slope * time_s * (1.0 - a) + behind * a;
    lagged[k] += behind;
  }
  return lagged;
}

}  // namespace flextip::arms
