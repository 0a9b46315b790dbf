// Numbers that no sensor should give, for tests that nothing of a control loop breaks by them.
#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "tests/repetitions.h"

namespace flextip {

/// Returns how many trials a hostile test makes: `usual`, or what FLEXTIP_HOSTILE_TRIALS says.
inline long HostileTrials(int usual) {
  const char* said = std::getenv("FLEXTIP_HOSTILE_TRIALS");
  return said != nullptr ? std::atol(said) : Repetitions(usual);
}

/// Draws numbers of all sizes and kinds, and breaks numbers of a good input.
class Hostile {
 public:
  explicit Hostile(unsigned seed) : rng_(seed) {}

  /// Returns an integer from 0 to n - 1.
  int Below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(rng_); }
  bool OneIn(int n) { return Below(n) == 0; }
  /// Returns 10 to the power of a number evenly drawn from `low` to `high`.
  double Size(double low, double high) {
    return std::pow(10.0, std::uniform_real_distribution<double>(low, high)(rng_));
  }
  /// Returns a wrong value for what was `good`: of any size a double has, or none; half of them
  /// within a factor of 1e6 of the good one, where it still looks like a number of its kind.
  double Wrong(double good) {
    const double sign = OneIn(2) ? -1.0 : 1.0;
    using Limits = std::numeric_limits<double>;
    switch (Below(12)) {
      case 0:
        return Limits::quiet_NaN();
      case 1:
        return sign * Limits::infinity();
      case 2:
        return sign * Limits::denorm_min() * Size(0.0, 15.0);
      case 3:
        return sign * Limits::max() * Size(-3.0, 0.0);
      case 4:
        return 0.0;
      case 5:
        return sign * Size(-320.0, 308.0);
      default:
        return sign * (good == 0.0 ? 1.0 : good) * Size(-6.0, 6.0);
    }
  }
  /// Breaks one to three of the numbers, now and then all of them.
  void Break(const std::vector<double*>& numbers) {
    if (OneIn(50)) {
      for (double* number : numbers) *number = Wrong(*number);
      return;
    }
    for (int left = 1 + Below(3); left > 0; --left) {
      double& number = *numbers[Below(static_cast<int>(numbers.size()))];
      number = Wrong(number);
    }
  }

 private:
  std::mt19937_64 rng_;
};

/// Adds the numbers of a matrix to `numbers`.
template <class Matrix>
void AddNumbers(Matrix& matrix, std::vector<double*>& numbers) {
  for (int i = 0; i < matrix.size(); ++i) numbers.push_back(matrix.data() + i);
}

}  // namespace flextip
