#include "control/supervision/chi_squared.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <limits>

namespace flextip {

ChiSquaredLimits::ChiSquaredLimits(double false_alarm) {
  for (int i = 0; i < kMost; ++i) {
    const boost::math::chi_squared distribution(i + 1);
    limits_[i] = boost::math::quantile(boost::math::complement(distribution, false_alarm));
  }
}

double ChiSquaredLimits::Of(int degrees) const {
  if (degrees < 1) return std::numeric_limits<double>::infinity();
  return limits_[static_cast<std::size_t>(std::min(degrees, kMost) - 1)];
}

}  // namespace flextip
