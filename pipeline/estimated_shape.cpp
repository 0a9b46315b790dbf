#include "pipeline/estimated_shape.h"

#include <array>

#include "core/check.h"
#include "estimation/shaft_rod.h"

namespace flextip {
namespace {

ShaftProblem ProblemOf(const ShaftModel& model, const Eigen::Vector3d& p_RW) {
  ShaftProblem problem;
  problem.rod.rod.length_m = model.instrument.length_m;
  problem.rod.rod.bending_stiffness_Nm2 = model.instrument.bending_stiffness_Nm2;
  problem.rod.rod.stiffness_taper = model.instrument.stiffness_taper;
  problem.rod.rod.p_wrist = p_RW + model.wrist_shift_m;
  problem.rod.rod.p_port = model.p_RP;
  problem.rod.rod.f_tip = model.f_tip_N;
  problem.rod.rod.q_weight = model.weight_N_m;
  problem.rod.effects = model.effects;
  problem.tip_compliance_m_N = model.tip_compliance_m_N;
  return problem;
}

}  // namespace

std::vector<ShapePoint> EstimatedShape(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW,
                                       int count) {
  FLEXTIP_CHECK(count >= 2, "both ends");
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (!fitted) return {};
  const ShaftProblem problem = ProblemOf(estimate.model, p_RW);
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
