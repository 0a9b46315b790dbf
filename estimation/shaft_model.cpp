#include "estimation/shaft_model.h"

#include <cmath>

#include "core/place.h"

namespace flextip {
namespace {

// Wide of every instrument: they part a wrong number from a right one, not a good shaft from a bad
// one (that is plausibility/).
constexpr double kShortest_m = 1e-3, kLongest_m = 10.0;
constexpr double kSoftest_Nm2 = 1e-9, kStiffest_Nm2 = 1e6;
// In units of EI / L^2, in which a shaft buckles at some ten: none is near its straight shape.
constexpr double kMostLoad = 1e3;
constexpr double kMostBend_rad = 100.0;  // unloaded, or by a load, over the whole length
constexpr double kMostCompliance_m_N = 10.0, kStiffestTissue_N_m = 1e7, kMostFriction = 100.0;
constexpr double kMostTaper = 2.0;
constexpr double kOrthonormal = 1e-3, kSameLength = 1e-3;

/// False for what is not a number, too.
bool IsWithin(double value, double low, double high) { return value >= low && value <= high; }

template <class V>
bool IsSmall(const Eigen::MatrixBase<V>& v, double most) {
  return v.cwiseAbs().template maxCoeff<Eigen::PropagateNaN>() <= most;
}

bool IsPlausible(const Instrument& i) {
  return IsWithin(i.length_m, kShortest_m, kLongest_m) &&
         IsWithin(i.bending_stiffness_Nm2, kSoftest_Nm2, kStiffest_Nm2) &&
         std::abs(i.stiffness_taper) < kMostTaper;
}

/// `unit_N`: EI / L^2.
bool IsPlausible(const RodEffects& e, double length_m, double unit_N) {
  return IsSmall(e.y_wrist, kFarthestPlace_m) &&
         IsSmall(e.curvature_1_m * length_m, kMostBend_rad) &&
         IsWithin(e.port_compliance_m_N, -kMostCompliance_m_N, kMostCompliance_m_N) &&
         IsWithin(e.wrist_compliance_m_N, -kMostCompliance_m_N, kMostCompliance_m_N) &&
         IsSmall(e.port_couple_Nm, kMostLoad * unit_N * length_m) &&
         IsWithin(e.port_friction, -kMostFriction, kMostFriction) &&
         IsSmall(e.q_inside_N_m * length_m, kMostLoad * unit_N);
}

bool IsPlausible(const BeamFit& beam, double length_m) {
  return IsSmall(beam.R_RM.transpose() * beam.R_RM - Eigen::Matrix3d::Identity(), kOrthonormal) &&
         std::abs(beam.length_m - length_m) <= kSameLength * length_m && beam.a > 0.0 &&
         beam.a < beam.length_m && std::abs(beam.F_p_over_EI) * length_m * length_m <= kMostLoad;
}

}  // namespace

bool IsPlausible(const ShaftModel& model) {
  if (!IsPlausible(model.instrument)) return false;
  const double L = model.instrument.length_m;
  const double unit_N = model.instrument.bending_stiffness_Nm2 / (L * L);
  return IsPlace(model.p_RP) && IsSmall(model.f_tip_N, kMostLoad * unit_N) &&
         IsSmall(model.weight_N_m * L, kMostLoad * unit_N) &&
         IsSmall(model.tissue_stiffness_N_m, kStiffestTissue_N_m) &&
         IsPlausible(model.effects, L, unit_N) &&
         IsWithin(model.tip_compliance_m_N, -kMostCompliance_m_N, kMostCompliance_m_N) &&
         IsSmall(model.wrist_shift_m, L) && IsSmall(model.wrist_misread_m, L) &&
         IsWithin(model.wrist_play_m, 0.0, L) &&
         (!model.beam.IsUsable() || IsPlausible(model.beam, L));
}

}  // namespace flextip
