#include "diagnosis/samples/noise_level.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kEnough = 60;           // differences
constexpr double kMedianOfSquare = 0.454936;  // of a squared standard normal
constexpr double kLeastMemory = 0.12;         // smaller coefficients are chance
constexpr double kMostMemory = 0.85;
constexpr double kFar = 10.0;     // mean square of a sample's rows over the median, or over noise
constexpr double kFewFar = 0.01;  // of all samples

double RobustVariance(std::vector<double> squares) {
  return Median(std::move(squares)) / kMedianOfSquare;
}

/// Variance of second differences of an AR(1) process of unit variance.
double SecondDifference(double phi) { return 6.0 - 8.0 * phi + 2.0 * phi * phi; }

/// The coefficient whose second differences over two steps and over one have this ratio of
/// variances.
double MemoryFrom(double ratio) {
  double low = 0.0, high = kMostMemory;
  for (int i = 0; i < 40; ++i) {
    const double phi = 0.5 * (low + high);
    (SecondDifference(phi * phi) / SecondDifference(phi) < ratio ? low : high) = phi;
  }
  return low < kLeastMemory ? 0.0 : low;
}

/// Of one measured row: variance and memory of its whitened residual.
double ScaleOf(const WhitenedRows& rows, int r) {
  std::vector<double> series;
  for (std::size_t k = 0; k + 1 < rows.first_row.size(); ++k) {
    const auto& used = rows.rows[k];
    const auto at = std::find(used.begin(), used.end(), r);
    if (at != used.end()) series.push_back(rows.e[rows.first_row[k] + (at - used.begin())]);
  }
  if (series.size() < kEnough) return 1.0;
  std::vector<double> near, far;
  for (std::size_t i = 4; i < series.size(); ++i) {
    near.push_back(std::pow(series[i] - 2 * series[i - 1] + series[i - 2], 2));
    far.push_back(std::pow(series[i] - 2 * series[i - 2] + series[i - 4], 2));
  }
  const double one = RobustVariance(near), two = RobustVariance(far);
  const double phi = MemoryFrom(two / one);
  const double variance = one / SecondDifference(phi);
  return std::sqrt(std::max(1.0, variance) * (1.0 + phi) / (1.0 - phi));
}

/// Of each sample's whitened rows.
std::vector<double> MeanSquares(const Replay& replay) {
  const WhitenedRows rows = replay.Whiten();
  std::vector<double> mean_squares;
  for (std::size_t k = 0; k + 1 < rows.first_row.size(); ++k) {
    const double squares = rows.e.segment(rows.first_row[k], rows.Rows(k)).squaredNorm();
    mean_squares.push_back(squares / std::max(1, rows.Rows(k)));
  }
  return mean_squares;
}

}  // namespace

std::array<double, kChannelCount> NoiseScale(const Replay& replay) {
  std::array<double, kChannelCount> scale;
  scale.fill(1.0);
  const WhitenedRows rows = replay.Whiten();
  for (int c = 0; c < kChannelCount; ++c) {
    double sum = 0.0;
    for (int i = 0; i < kChannels[c].rows; ++i) sum += ScaleOf(rows, kChannels[c].first_row + i);
    // Within a tenth of the data sheet is the data sheet.
    const double mean = sum / kChannels[c].rows;
    scale[c] = mean < 1.1 ? 1.0 : mean;
  }
  return scale;
}

std::vector<std::size_t> FarSamples(const Replay& replay) {
  const std::vector<double> mean_squares = MeanSquares(replay);
  if (mean_squares.empty()) return {};
  const double limit = kFar * std::max(1.0, Median(mean_squares));
  std::vector<std::size_t> far;
  for (std::size_t k = 0; k < mean_squares.size(); ++k)
    if (mean_squares[k] > limit) far.push_back(k);
  if (double(far.size()) > kFewFar * double(mean_squares.size())) far.clear();
  return far;
}

double MedianMisfit(const Replay& replay) { return std::sqrt(Median(MeanSquares(replay))); }

}  // namespace flextip::diagnosis
