// Residuals that remember themselves, as an autoregression: what is left of them is white.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace flextip {

/// x_i = sum_k a_k x_(i-k) + innovation.
struct Autoregression {
  Eigen::VectorXd coefficients = {};  ///< a_1, a_2, ...

  Eigen::Index Order() const { return coefficients.size(); }
  /// Returns the columns' innovations. `before` is how many samples without a gap there are before
  /// each one; the rows of those with less than the order are 0.
  Eigen::MatrixXd Innovations(const Eigen::MatrixXd& columns, const std::vector<int>& before) const;
};

/// Fits the order (up to 16) that Akaike's criterion takes, by least squares over all stretches
/// without a gap. See Brockwell and Davis, Time Series: Theory and Methods, 1991, ch. 9.
Autoregression FitAutoregression(const Eigen::VectorXd& x, const std::vector<int>& before);

/// Returns for each time how many samples come before it without a gap of 1.6 periods.
std::vector<int> WithoutGap(const std::vector<double>& t_s, double period_s);

}  // namespace flextip
