#include "arms/search/noise.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/evidence/residual_memory.h"

namespace flextip::arms {
namespace {

constexpr double kWild = 8.0;       // robust standard deviations
constexpr double kNormal = 1.4826;  // median of absolute values to standard deviation
constexpr double kLeastFloor = 1e-7;

double MedianOfAbsolute(std::vector<double> values) {
  if (values.empty()) return 0.0;
  for (double& v : values) v = std::abs(v);
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// By second differences, which slow signals leave alone.
double NoiseOfDifferences(const std::vector<double>& values) {
  std::vector<double> differences;
  for (std::size_t k = 2; k < values.size(); ++k)
    differences.push_back(values[k] - 2.0 * values[k - 1] + values[k - 2]);
  return kNormal * MedianOfAbsolute(differences) / std::sqrt(6.0);
}

}  // namespace

Noise MeasureNoise(const Replay& replay, bool find_wild) {
  Noise noise;
  for (const Channel& channel : replay.Channels()) {
    const Eigen::Index C = channel.Components();
    ChannelNoise own;
    own.floor = channel.stated;
    own.sd = own.memory = own.left = Eigen::VectorXd::Zero(C);
    own.keep = channel.residual.array().isFinite();
    for (Eigen::Index c = 0; c < C; ++c) {
      std::vector<double> values;
      for (Eigen::Index k = 0; k < channel.Rows(); ++k)
        if (own.keep(k, c)) values.push_back(channel.residual(k, c));
      if (values.empty()) {
        own.floor[c] = own.sd[c] = 1.0;
        continue;
      }
      if (own.floor[c] <= 0.0) own.floor[c] = NoiseOfDifferences(values);
      own.floor[c] = std::max(own.floor[c], kLeastFloor);
      const double wild = kWild * std::max(own.floor[c], kNormal * MedianOfAbsolute(values));
      std::vector<double> kept;
      double squares = 0.0;
      for (Eigen::Index k = 0; k < channel.Rows(); ++k) {
        if (!own.keep(k, c)) continue;
        if (find_wild && std::abs(channel.residual(k, c)) > wild) {
          own.keep(k, c) = false;
          continue;
        }
        kept.push_back(channel.residual(k, c) / own.floor[c]);
        squares += kept.back() * kept.back();
      }
      const diagnosis::ResidualMemory memory = diagnosis::MemoryOfSeries(kept);
      const double mean = squares / double(kept.size());
      own.memory[c] = memory.correlation;
      own.left[c] = own.floor[c] * std::sqrt(mean);
      own.sd[c] = own.floor[c] * std::sqrt(std::max({1.0, mean, memory.slow_variance}));
    }
    noise.push_back(std::move(own));
  }
  return noise;
}

long LeftOut(const Replay& replay, const Noise& noise) {
  long count = 0;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const auto measured = replay.Channels()[i].residual.array().isFinite();
    count += (measured && !noise[i].keep).count();
  }
  return count;
}

}  // namespace flextip::arms
