#include "vision/photometric/normal_table.h"

#include <cmath>

namespace flextip {

NormalTable::NormalTable() {
  const auto cdf = [](double x) { return 0.5 * std::erfc(-x * M_SQRT1_2); };
  const double low = cdf(-kReach);  // the tails are cut and the rest stretched to 0..1
  for (int i = 0; i < static_cast<int>(values_.size()); ++i) {
    const double x = -kReach + 2.0 * kReach * i / kSteps;
    values_[i] = {static_cast<float>((cdf(x) - low) / (1 - 2 * low)),
                  static_cast<float>(std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI) / (1 - 2 * low))};
  }
}

const NormalTable& NormalTable::Get() {
  static const NormalTable table;
  return table;
}

}  // namespace flextip
