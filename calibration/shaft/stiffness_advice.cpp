#include <fmt/format.h>

#include <cmath>

#include "calibration/shaft/next_load.h"
#include "calibration/shaft/stiffness_model_fit.h"
#include "core/linear_algebra.h"

namespace flextip {
namespace {

/// The variance that matters, after one more hold.
double VarianceWith(const StiffnessMatrix& information, int unknown) {
  const StiffnessVector unit = information.diagonal().cwiseSqrt().cwiseInverse();
  const StiffnessMatrix scaled = unit.asDiagonal() * information * unit.asDiagonal();
  const StiffnessVector e = StiffnessVector::Unit(kStiffnessUnknowns, unknown);
  return unit[unknown] * unit[unknown] * Ldlt(scaled).Solve(e)[unknown];
}

}  // namespace

std::string AdviseLoad(StiffnessModelFit& chosen, bool for_taper, const Eigen::Vector3d& p_RP,
                       const StiffnessCalibration& result) {
  const int unknown = for_taper ? kStiffnessTaper : kLogStiffness;
  std::vector<PlacedHold> placed;
  for (const auto& h : result.holds) {
    if (h.used && h.measurements > 0) placed.push_back({h.hold, h.s_port_m});
  }
  const double now = VarianceWith(chosen.fit().information, unknown);
  double best = now;
  std::string words;
  for (const NextLoad& next : NextLoads(placed, p_RP)) {
    const StiffnessRows rows = chosen.fitter().RowsOf(next.hold, chosen.fit().x);
    if (!rows.usable) continue;
    const double then =
        VarianceWith(chosen.fit().information + rows.by_unknowns.transpose() *
                                                    Ldlt(rows.covariance).Solve(rows.by_unknowns),
                     unknown);
    if (!(then < best)) continue;
    best = then;
    words = next.words;
  }
  if (!(best <= 0.94 * now)) return "";  // nor where nothing is known yet
  return fmt::format("{} (the {}'s standard deviation falls to {:.0f} %)", words,
                     for_taper ? "taper" : "stiffness", 100 * std::sqrt(best / now));
}

}  // namespace flextip
