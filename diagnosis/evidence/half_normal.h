// Normal distributions of parameters that cannot be negative.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace flextip::diagnosis {

/// log of the standard normal's distribution function, to 1e-9 relative wherever it is finite.
double LogPhi(double x);

/// log of the probability that all components in `positive` of a normal vector are positive. Exact
/// for one of them; more are taken one after the other, each truncated normal replaced by the
/// normal of its mean and variance (Mendell & Elston 1974), the least likely one first.
double LogPositive(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                   const std::vector<int>& positive);

/// The most likely point of the normal distribution where no component in `positive` is negative.
Eigen::VectorXd PositiveMode(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             const std::vector<int>& positive);

}  // namespace flextip::diagnosis
