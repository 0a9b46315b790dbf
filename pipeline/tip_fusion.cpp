#include "pipeline/tip_fusion.h"

namespace flextip {

std::optional<Eigen::Vector3d> MeasuredTip(const Measurements& z, bool em_is_tip) {
  if (z.tip && z.tip->status != TipStatus::kLost) return z.tip->p_RE;
  if (!em_is_tip || !z.em) return {};
  return z.em->T_RS.p + z.em->distance_from_tip_m * z.em->T_RS.R.col(0);
}

std::optional<Eigen::Vector3d> FuseTip(ControllerKind kind, const Measurements& measurements,
                                       const ShaftEstimate& estimate, bool em_is_tip) {
  const auto tip = MeasuredTip(measurements, em_is_tip);
  const bool fused =
      tip && kind == ControllerKind::kRodTrack && estimate.status == EstimateStatus::kOk;
  return fused ? estimate.p_RE : tip;
}

}  // namespace flextip
