#include "calibration/em/lag.h"

#include <cmath>

#include "calibration/residual_statistics.h"

namespace flextip {

EmLag LagOf(const std::vector<EmPair>& pairs, const std::vector<Eigen::Vector3d>& errors_R,
            const std::vector<bool>& used, double distance_m) {
  const auto place = [&](std::size_t i) -> Eigen::Vector3d {
    return pairs[i].p_RE - distance_m * pairs[i].t_RE;
  };
  double along = 0.0, squares = 0.0;
  std::vector<Eigen::Vector3d> errors, velocities;
  for (std::size_t i = 1; i + 1 < pairs.size(); ++i) {
    if (!used[i] || !used[i - 1] || !used[i + 1]) continue;
    const double seconds = 1e-9 * static_cast<double>(pairs[i + 1].t_ns - pairs[i - 1].t_ns);
    velocities.emplace_back((place(i + 1) - place(i - 1)) / seconds);
    errors.push_back(errors_R[i]);
    along -= velocities.back().dot(errors.back());
    squares += velocities.back().squaredNorm();
  }
  if (squares <= 0.0) return {};
  EmLag lag{.late_s = along / squares};
  double rest = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    errors[i] += lag.late_s * velocities[i];
    rest += errors[i].squaredNorm();
  }
  const double variance = rest / (3.0 * static_cast<double>(errors.size()));
  lag.sd_s = std::sqrt(variance * CorrelationTime(errors) / squares);
  return lag;
}

}  // namespace flextip
