// Limits of chi-squared tests.
#pragma once

#include <array>

namespace flextip {

/// The values that a chi-squared with 1 to kMost degrees of freedom exceeds by chance with a stated
/// probability. Made once: a lookup afterwards.
class ChiSquaredLimits {
 public:
  static constexpr int kMost = 32;
  explicit ChiSquaredLimits(double false_alarm);
  /// Returns the limit; that of kMost for more degrees of freedom, infinity for none.
  double Of(int degrees) const;

 private:
  std::array<double, kMost> limits_;
};

}  // namespace flextip
