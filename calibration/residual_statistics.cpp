#include "calibration/residual_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/median.h"

namespace flextip {
namespace {

constexpr double kMedianLength = 1.5381722544550522;  // of three standard normal numbers

double ProbabilityBeyond(double length) {
  return std::erfc(length / std::numbers::sqrt2) +
         std::sqrt(2.0 / std::numbers::pi) * length * std::exp(-0.5 * length * length);
}

}  // namespace

double LengthExceeded(double probability) {
  double low = 0.0, high = 40.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (ProbabilityBeyond(middle) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double OutlierLimit(std::size_t count) {
  return LengthExceeded(0.01 / static_cast<double>(std::max<std::size_t>(1, count)));
}

double RobustScale(const std::vector<double>& lengths) { return Median(lengths) / kMedianLength; }

double CorrelationTime(const std::vector<Eigen::Vector3d>& residuals) {
  const std::size_t n = residuals.size();
  if (n < 10) return 1.0;
  const double chance = 3.0 / std::sqrt(3.0 * static_cast<double>(n));
  double power = 0.0, time = 1.0;
  for (const auto& r : residuals) power += r.squaredNorm();
  for (std::size_t lag = 1; lag < n / 4; ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += residuals[i].dot(residuals[i - lag]);
    const double correlation = sum / power;
    if (!(correlation > chance)) break;
    time += 2.0 * correlation;
  }
  return time;
}

}  // namespace flextip
