#include "arms/data/smooth.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

/// Rows `from` to `to` that lie around row k, at least five.
std::pair<Eigen::Index, Eigen::Index> Around(const Eigen::VectorXd& t_s, Eigen::Index k) {
  Eigen::Index from = k, to = k;
  const Eigen::Index last = t_s.size() - 1;
  while (from > 0 && t_s[k] - t_s[from - 1] <= kSmoothing_s) --from;
  while (to < last && t_s[to + 1] - t_s[k] <= kSmoothing_s) ++to;
  while (to - from < 4 && (from > 0 || to < last)) {
    if (from > 0) --from;
    if (to < last) ++to;
  }
  return {from, to};
}

/// 4 x rows: the cubic's coefficients from the rows' values.
Eigen::MatrixXd CubicOf(const Eigen::VectorXd& t_s, Eigen::Index from, Eigen::Index to,
                        double about) {
  const Eigen::Index rows = to - from + 1;
  const int degree = int(std::min<Eigen::Index>(3, rows - 1));
  Eigen::MatrixXd A(rows, degree + 1);
  for (Eigen::Index r = 0; r < rows; ++r) {
    double power = 1.0;
    for (int d = 0; d <= degree; ++d, power *= (t_s[from + r] - about) / kSmoothing_s)
      A(r, d) = power;
  }
  Eigen::MatrixXd N = A.transpose() * A;
  N.diagonal().array() += 1e-12;
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(4, rows);
  full.topRows(degree + 1) = Llt(N).Solve(Eigen::MatrixXd(A.transpose()));
  return full;
}

}  // namespace

void SmoothRates(const Track& joints, Eigen::MatrixXd& smooth, Eigen::MatrixXd& rate,
                 Eigen::MatrixXd& acceleration) {
  const Eigen::Index rows = joints.Rows(), n = joints.values.cols();
  smooth = rate = acceleration = Eigen::MatrixXd::Zero(rows, n);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const auto [from, to] = Around(joints.t_s, k);
    const Eigen::MatrixXd cubic = CubicOf(joints.t_s, from, to, joints.t_s[k]) *
                                  joints.values.middleRows(from, to - from + 1);
    smooth.row(k) = cubic.row(0);
    rate.row(k) = cubic.row(1) / kSmoothing_s;
    acceleration.row(k) = 2.0 * cubic.row(2) / (kSmoothing_s * kSmoothing_s);
  }
}

Eigen::MatrixXd Smoothed(const Track& track) {
  Eigen::MatrixXd smooth, rate, acceleration;
  SmoothRates(track, smooth, rate, acceleration);
  return smooth;
}

}  // namespace flextip::arms
