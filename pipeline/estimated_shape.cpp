#include "pipeline/estimated_shape.h"

#include <array>

#include "core/check.h"
#include "estimation/shaft_rod.h"

namespace flextip {
std::vector<ShapePoint> EstimatedShape(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW,
                                       int count) {
  FLEXTIP_CHECK(count >= 2, "both ends");
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (!fitted) return {};
  const ShaftProblem problem = RodOf(estimate.model, p_RW);
  std::vector<ShapePoint> shape;
  ShaftRod rod;
  for (int i = 0; i < count; ++i) {
    const std::array station{RodStation{problem.rod.rod.length_m * i / (count - 1)}};
    const ShaftRodState state = rod.Solve(problem, station);
    if (!state.IsUsable()) return {};
    const ShaftSection& at = state.stations[0];
    shape.push_back({station[0].s_m, at.p, at.dp * estimate.covariance * at.dp.transpose()});
  }
  return shape;
}

}  // namespace flextip
