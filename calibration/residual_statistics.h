// What the calibrations of tip and EM sensor share: limits for outliers and how long noise lasts.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace flextip {

/// The length of a vector of three standard normal numbers that is exceeded with `probability`.
double LengthExceeded(double probability);

/// The limit, in standard deviations, beyond which one of `count` residuals of three components is
/// an outlier: all of them stay within it with 99 %.
double OutlierLimit(std::size_t count);

/// The factor by which whitened lengths of three components are too long, from their median.
double RobustScale(const std::vector<double>& lengths);

/// By how much the residuals' covariance of a mean is larger than of independent ones: one plus
/// twice the sum of their autocorrelation up to where it is within chance (Sokal's integrated
/// time); 1 where the first is within chance already. In the order of time.
double CorrelationTime(const std::vector<Eigen::Vector3d>& residuals);

}  // namespace flextip
