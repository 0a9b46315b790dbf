#include "exchange/streams/noise.h"

#include <cmath>
#include <limits>

#include "core/median.h"

namespace flextip::exchange {
namespace {

constexpr std::size_t kFewestForNoise = 20;
constexpr double kRounding = 1e-12;  // relative: smaller differences are those of the arithmetic

double LargestOf(const std::vector<Eigen::VectorXd>& values) {
  double largest = 0.0;
  for (const auto& value : values) largest = std::fmax(largest, value.cwiseAbs().maxCoeff());
  return largest;
}

// The smallest step of any component; 0 where none changes.
double SmallestStep(const std::vector<Eigen::VectorXd>& values, double largest) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) {
    for (const double step : Eigen::VectorXd((values[i] - values[i - 1]).cwiseAbs())) {
      if (step > kRounding * largest) smallest = std::fmin(smallest, step);
    }
  }
  return std::isfinite(smallest) ? smallest : 0.0;
}

}  // namespace

std::optional<MeasuredNoise> MeasureNoise(const std::vector<Eigen::VectorXd>& values) {
  if (values.size() < kFewestForNoise) return {};
  std::vector<double> squares;
  for (std::size_t i = 3; i < values.size(); ++i) {
    squares.push_back(
        (values[i] - 3 * values[i - 1] + 3 * values[i - 2] - values[i - 3]).squaredNorm());
  }
  // Of n components with deviation s the square is 20 s^2 times a chi-square of n degrees, whose
  // median Wilson and Hilferty approximate.
  const auto n = static_cast<double>(values.front().size());
  const double chi2_median = n * std::pow(1.0 - 2.0 / (9.0 * n), 3);
  const double sd = std::sqrt(Median(squares) / (20.0 * chi2_median));
  const double largest = LargestOf(values);
  if (sd > kRounding * largest) return MeasuredNoise{sd, "measured by third differences"};
  const double step = SmallestStep(values, largest);
  if (step == 0.0) return {};
  return MeasuredNoise{step / std::sqrt(12.0), "of rounding to the smallest step of the values"};
}

std::optional<MeasuredNoise> MeasureNoise(std::vector<Eigen::Quaterniond> rotations) {
  // Small turns from one to the next, added up: a rotation's noise moves them as a vector's.
  std::vector<Eigen::VectorXd> turns;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    if (i > 0) {
      Eigen::Quaterniond step = rotations[i - 1].conjugate() * rotations[i];
      if (step.w() < 0) step.coeffs() = -step.coeffs();
      sum += 2.0 * step.vec();
    }
    turns.emplace_back(sum);
  }
  return MeasureNoise(turns);
}

}  // namespace flextip::exchange
