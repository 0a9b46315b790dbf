#include "reproduction/chapter3/beam.h"

#include <cmath>

#include "kinematics/plane_beam.h"
#include "kinematics/straight.h"
#include "reproduction/printed_jacobian.h"

namespace flextip::reproduction {
namespace {

Eigen::Vector2d Turned(double angle, double x, double y) {
  return Eigen::Rotation2Dd(angle) * Eigen::Vector2d(x, y);
}

/// With phi as the angle of the line from wrist to port (docs/errata.md).
Eigen::Matrix2d PrintedJacobian(const BeamState& state) {
  const double y_a = BeamPortHeight(state.F, state.a, state.length_m);
  return PrintedPlaneJacobian(state.a, y_a, state.length_m, state.phi + std::atan(y_a / state.a),
                              Turned(state.phi, state.a, y_a));
}

StraightShaft Lever(const BeamState& state) {
  const Eigen::Vector2d port = state.Port();
  return SolveStraight({state.p_wrist.x(), state.p_wrist.y(), 0.0}, {port.x(), port.y(), 0.0},
                       state.length_m);
}

}  // namespace

const char* Name(FlexionForm form) {
  switch (form) {
    case FlexionForm::kPrinted:
      return "as printed";
    case FlexionForm::kPortForce:
      return "corrected, F_p held";
    case FlexionForm::kTipForce:
      return "corrected, F_t held";
  }
  return "";
}

Eigen::Vector2d BeamState::Port() const {
  return p_wrist + Turned(phi, a, BeamPortHeight(F, a, length_m));
}

Eigen::Vector2d BeamState::Tip() const { return p_wrist + Turned(phi, length_m, 0.0); }

BeamState BeamAtDepth(const BentShaft& shaft, double depth_m) {
  const double L = shaft.length_m;
  BeamState state;
  state.length_m = L;
  const auto at = [&](double a) {
    state.a = a;
    state.F = -shaft.F_t_over_EI * L / a;  // (5.15)
    return (state.Tip() - state.Port()).norm();
  };
  double low = 0.0, high = L;  // the depth falls as the port moves to the tip
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (at(middle) > depth_m ? low : high) = middle;
  }
  at(0.5 * (low + high));
  return state;
}

Eigen::Matrix2d FlexionJacobian(FlexionForm form, const BeamState& state) {
  if (form == FlexionForm::kPrinted) return PrintedJacobian(state);
  const BeamLoadLaw law =
      form == FlexionForm::kPortForce ? BeamLoadLaw::kPortForce : BeamLoadLaw::kTipForce;
  return PlaneBeamJacobian(state.F, state.a, state.length_m, state.phi, law);
}

Eigen::Matrix2d LeverJacobian(const BeamState& state) {
  return Lever(state).J_tip_wrist.topLeftCorner<2, 2>();
}

Eigen::Vector2d LeverTip(const BeamState& state) { return Lever(state).p_tip.head<2>(); }

BeamReadings ReadingsOf(const BeamState& state) {
  const double L = state.length_m;
  BeamReadings readings;
  readings << state.p_wrist, state.Tip(),
      state.phi + std::atan(BeamSlope(state.F, state.a, L, 0.0)),
      state.phi + std::atan(BeamSlope(state.F, state.a, L, L));
  return readings;
}

BeamState EstimateBeam(const BeamReadings& readings, double length_m) {
  const double L = length_m;
  BeamState estimate;
  estimate.length_m = L;
  estimate.p_wrist = readings.head<2>();
  const Eigen::Vector2d chord = readings.segment<2>(2) - estimate.p_wrist;
  estimate.phi = std::atan2(chord.y(), chord.x());                         // (3.9)
  const double y_wrist = std::tan(readings[4] - estimate.phi);             // (3.13)
  const double y_tip = std::tan(readings[5] - estimate.phi);               // (3.14)
  estimate.a = L * (2.0 * y_tip + y_wrist) / (y_tip - y_wrist);            // (3.12)
  estimate.F = 2.0 * (y_wrist - y_tip) / (estimate.a * (estimate.a - L));  // (3.11)
  return estimate;
}

}  // namespace flextip::reproduction
