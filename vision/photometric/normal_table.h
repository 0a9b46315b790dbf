// The normal distribution from a table, for inner loops.
#pragma once

#include <array>

namespace flextip {

/// Cumulative distribution and density of the normal distribution cut at +-kReach, right to 1e-5.
/// Beyond, the distribution is 0 or 1 and the density 0; 2.3e-4 of the whole one lie there at
/// either end.
class NormalTable {
 public:
  static constexpr float kReach = 3.5f;
  static constexpr int kSteps = 512;

  static const NormalTable& Get();

  struct Value {
    float cdf, density;
  };
  Value At(float x) const {
    const float at = (x + kReach) * (kSteps / (2 * kReach));
    if (at <= 0) return {0, 0};
    if (at >= kSteps) return {1, 0};
    const int i = static_cast<int>(at);
    const float t = at - static_cast<float>(i);
    return {values_[i].cdf + t * (values_[i + 1].cdf - values_[i].cdf),
            values_[i].density + t * (values_[i + 1].density - values_[i].density)};
  }

 private:
  NormalTable();
  std::array<Value, kSteps + 2> values_;
};

}  // namespace flextip
