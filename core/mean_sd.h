// Mean and standard deviation of some numbers.
#pragma once

#include <cmath>
#include <vector>

namespace flextip {

struct MeanSd {
  double mean = 0.0, sd = 0.0;  ///< `sd` of the sample, with n - 1; 0 for fewer than two numbers
  int count = 0;

  /// Returns the standard error of the mean, 0 without numbers.
  double StandardError() const { return count > 0 ? sd / std::sqrt(count) : 0.0; }
};

/// Returns all zeros where there are no numbers.
inline MeanSd MeanSdOf(const std::vector<double>& values) {
  MeanSd of;
  of.count = static_cast<int>(values.size());
  if (values.empty()) return of;
  for (const double value : values) of.mean += value / of.count;
  double squares = 0.0;
  for (const double value : values) squares += (value - of.mean) * (value - of.mean);
  of.sd = of.count > 1 ? std::sqrt(squares / (of.count - 1)) : 0.0;
  return of;
}

}  // namespace flextip
