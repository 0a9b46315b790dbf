#include "plausibility/limits/hung_mass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flextip::plausibility {

std::vector<Finding> CheckHungMass(const Recording& recording, const std::vector<Finding>& found) {
  constexpr std::size_t kFewest = 20;
  constexpr double kLeast_N = 0.05, kAgainst = -0.995;  // cosine
  const Eigen::Vector3d& g = recording.gravity_m_s2;
  if (!recording.load0 || g.norm() == 0.0 || recording.load0->f_tip_N.size() < kFewest) return {};
  for (const Finding& f : found)
    if (f.Subject() == "load0") return {};
  const auto& forces = recording.load0->f_tip_N;
  const double n = static_cast<double>(forces.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& f : forces) mean += f.value / n;
  double variance = 0.0;
  for (const auto& f : forces) variance += (f.value - mean).squaredNorm() / (3.0 * n);
  const double noise = std::max(2.0 * recording.load0->force_noise_N, 0.01 * mean.norm());
  if (mean.norm() <= kLeast_N || std::sqrt(variance) >= noise) return {};
  if (mean.dot(g) > kAgainst * mean.norm() * g.norm()) return {};
  return {{Severity::kWrong, "gravity.sign",
           fmt::format("gravity_m_s2 looks upside down: load0 is constant, {:.3g} N, and points "
                       "against it, as a hung mass never does",
                       mean.norm()),
           fmt::format("gravity_m_s2: [{:.4g}, {:.4g}, {:.4g}] in recording.yaml", -g.x(), -g.y(),
                       -g.z())}};
}

}  // namespace flextip::plausibility
