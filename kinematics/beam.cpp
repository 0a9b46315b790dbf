#include "kinematics/beam.h"

#include <cassert>
#include <cmath>

#include "core/rotation.h"
#include "kinematics/large_deflection.h"
#include "kinematics/plane_beam.h"

namespace flextip {

const char* Name(BeamStatus status) {
  switch (status) {
    case BeamStatus::kOk:
      return "ok";
    case BeamStatus::kStraight:
      return "straight";
    case BeamStatus::kBadInput:
      return "bad input";
    case BeamStatus::kNoPort:
      return "no port on the shaft";
  }
  return "?";
}

namespace {

// The port lies on e1 at `distance`, the force pushes the tip along -e2. The force's part across
// the chord depends on the chord, so the two are found in turn; a few rounds settle them.
PlaneBeam SolveInPlane(double distance, double f_along, double f_across, double EI, double L) {
  PlaneBeamProblem problem;
  problem.p_port = {distance, 0.0};
  problem.length_m = L;
  PlaneBeam beam;
  for (int i = 0; i < 100; ++i) {
    // -f . v_y, with f = (f_along, -f_across) and v_y = (-sin phi, cos phi)
    const double F_t = f_along * std::sin(beam.phi) + f_across * std::cos(beam.phi);
    const double before = beam.phi;
    problem.load_over_EI = -F_t / EI;
    beam = SolvePlaneBeam(problem);
    if (!beam.IsUsable() || std::abs(beam.phi - before) < 1e-14) break;
  }
  return beam;
}

}  // namespace

BeamFit SolveBeam(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RP,
                  const Eigen::Vector3d& f_tip, double bending_stiffness_Nm2,
                  double length_m) noexcept {
  BeamFit fit;
  const Eigen::Vector3d to_port = p_RP - p_RW;
  const double distance = to_port.norm();
  if (!(bending_stiffness_Nm2 > 0) || !std::isfinite(bending_stiffness_Nm2) || !(length_m > 0) ||
      !std::isfinite(length_m) || !std::isfinite(distance) || !f_tip.allFinite()) {
    return fit;
  }
  fit.length_m = length_m;
  fit.status = BeamStatus::kNoPort;
  if (distance < 1e-9 * length_m || distance >= length_m) return fit;

  const Eigen::Vector3d e1 = to_port / distance;
  const double f_along = f_tip.dot(e1);
  const Eigen::Vector3d across = f_tip - f_along * e1;
  const double f_across = across.norm();
  if (f_across * length_m * length_m < 1e-12 * bending_stiffness_Nm2) {
    fit.status = BeamStatus::kStraight;
    fit.a = distance;
    fit.R_RM << e1, NormalBasis(e1);
    return fit;
  }
  const Eigen::Vector3d e2 = -across / f_across;
  const PlaneBeam beam = SolveInPlane(distance, f_along, f_across, bending_stiffness_Nm2, length_m);
  fit.status = beam.status;
  if (!beam.IsUsable()) return fit;
  fit.F_p_over_EI = beam.F_p_over_EI;
  fit.a = beam.a;
  fit.R_RM.col(0) = std::cos(beam.phi) * e1 + std::sin(beam.phi) * e2;
  fit.R_RM.col(1) = -std::sin(beam.phi) * e1 + std::cos(beam.phi) * e2;
  fit.R_RM.col(2) = e1.cross(e2);
  return fit;
}

Eigen::Matrix3d BeamJacobian(const BeamFit& fit, BeamLoadLaw law) noexcept {
  assert(fit.a > 0 && fit.a < fit.length_m);
  Eigen::Matrix3d J_M = Eigen::Matrix3d::Zero();
  J_M.topLeftCorner<2, 2>() =
      PlaneBeamJacobian(fit.F_p_over_EI, fit.a, fit.length_m, 0.0, law);  // M's x is the chord
  J_M(2, 2) = -(fit.length_m - fit.a) / fit.a;
  return fit.R_RM * J_M * fit.R_RM.transpose();
}

Eigen::Vector3d BeamTip(const BeamFit& fit, const Eigen::Vector3d& p_RW) noexcept {
  // (5.23)'s extra rotation is zero for a fit that reproduces the slopes (docs/errata.md).
  return p_RW + BentChord(fit.F_p_over_EI, fit.a, fit.length_m) * fit.R_RM.col(0);
}

Eigen::Vector3d BeamPort(const BeamFit& fit, const Eigen::Vector3d& p_RW) noexcept {
  const double y = BeamPortHeight(fit.F_p_over_EI, fit.a, fit.length_m);
  return p_RW + fit.a * fit.R_RM.col(0) + y * fit.R_RM.col(1);
}

Eigen::Vector3d BeamTipLoad(const BeamFit& fit) noexcept {
  // The port pushes along -y_M where F_p > 0, so wrist and tip are pushed along +y_M.
  return fit.F_p_over_EI * fit.a / fit.length_m * fit.R_RM.col(1);
}

}  // namespace flextip
