#include "kinematics/plane_beam.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace flextip {
namespace {

// Returns the port's height and its derivative at `a`, for a load that obeys `law`.
struct PortHeight {
  double y, dy_da;
};
PortHeight PortHeightUnder(const PlaneBeamProblem& problem, double a) {
  const double L = problem.length_m;
  const double F = problem.law == BeamLoadLaw::kPortForce ? problem.load_over_EI
                                                          : problem.load_over_EI * L / a;  // (5.15)
  return {BeamPortHeight(F, a, L), BeamPortHeightRate(F, a, L, problem.law)};
}

// Solves (3.28) for `a`: the root of a^2 + y^2 - distance^2 nearest `distance`, by Newton's method
// kept inside a bracket. The function is below zero at 0 and not below it at `distance`.
double SolvePortPlace(const PlaneBeamProblem& problem, double distance) {
  double low = 0.0, high = distance, a = distance;
  for (int i = 0; i < 100; ++i) {
    const auto [y, dy] = PortHeightUnder(problem, a);
    const double f = (a * a + y * y - distance * distance) / distance;
    (f > 0 ? high : low) = a;
    const double slope = 2.0 * (a + y * dy) / distance;
    double next = slope > 0 ? a - f / slope : 0.5 * (low + high);
    if (next <= low || next >= high) next = 0.5 * (low + high);
    const double change = std::abs(next - a);
    a = next;
    if (change < 1e-15 * distance || high - low < 1e-15 * distance) break;
  }
  return a;
}

}  // namespace

double BeamHeight(double F, double a, double length, double x) noexcept {
  const double L = length, b = L - a, beyond = std::max(0.0, x - a);
  return -F / 6.0 *
         (L * b * x * (1.0 - b * b / (L * L) - x * x / (L * L)) + beyond * beyond * beyond);
}

double BeamSlope(double F, double a, double length, double x) noexcept {
  const double L = length, b = L - a, beyond = std::max(0.0, x - a);
  return -F / 6.0 *
         (L * b * (1.0 - b * b / (L * L) - 3.0 * x * x / (L * L)) + 3.0 * beyond * beyond);
}

double BeamPortHeight(double F, double a, double length) noexcept {
  const double b = length - a;
  return -F * a * a * b * b / (3.0 * length);
}

double BeamPortHeightRate(double F, double a, double length, BeamLoadLaw law) noexcept {
  const double b = length - a;
  const double per_F = -a * b / (3.0 * length);  // y = F per_F a b
  if (law == BeamLoadLaw::kPortForce) return 2.0 * F * per_F * (b - a);
  return F * per_F * (b - 2.0 * a);  // F = F_t L / a: y goes as a b^2
}

Eigen::Matrix2d PlaneBeamJacobian(double F, double a, double length, double phi,
                                  BeamLoadLaw law) noexcept {
  assert(a > 0 && a < length);
  const double y = BeamPortHeight(F, a, length);
  const double dy = BeamPortHeightRate(F, a, length, law);
  const double distance2 = a * a + y * y;  // (3.28)
  // With u the unit vector from wrist to port: (3.28) gives da/dp_w = -distance / (a + y y') u^T,
  // and (3.7) gives dphi = -u_perp^T dp_w / distance - (a y' - y) / distance^2 da. In M,
  // u = (a, y) / distance.
  const double kappa = (a * dy - y) / (a + y * dy);
  const Eigen::RowVector2d dphi_M = Eigen::RowVector2d(y + kappa * a, -a + kappa * y) / distance2;
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(phi).toRotationMatrix();
  const Eigen::RowVector2d dphi = dphi_M * R.transpose();
  return Eigen::Matrix2d::Identity() + length * R.col(1) * dphi;  // (3.6)
}

PlaneBeam SolvePlaneBeam(const PlaneBeamProblem& problem) noexcept {
  PlaneBeam beam;
  const Eigen::Vector2d to_port = problem.p_port - problem.p_wrist;
  const double distance = to_port.norm(), L = problem.length_m;
  if (!std::isfinite(distance) || !std::isfinite(L) || !std::isfinite(problem.load_over_EI) ||
      L <= 0) {
    return beam;
  }
  if (distance < 1e-9 * L || distance >= L) {
    beam.status = BeamStatus::kNoPort;
    return beam;
  }
  beam.status = BeamStatus::kOk;
  beam.a = SolvePortPlace(problem, distance);
  beam.F_p_over_EI = problem.load_over_EI;
  if (problem.law == BeamLoadLaw::kTipForce) beam.F_p_over_EI *= L / beam.a;  // (5.15)
  const double y = BeamPortHeight(beam.F_p_over_EI, beam.a, L);
  beam.phi = std::atan2(to_port.y(), to_port.x()) - std::atan2(y, beam.a);  // (3.7)
  beam.p_tip = problem.p_wrist + L * Eigen::Vector2d(std::cos(beam.phi), std::sin(beam.phi));
  beam.J_tip_wrist = PlaneBeamJacobian(beam.F_p_over_EI, beam.a, L, beam.phi, problem.law);
  beam.J_tip_port = Eigen::Matrix2d::Identity() - beam.J_tip_wrist;
  return beam;
}

}  // namespace flextip
