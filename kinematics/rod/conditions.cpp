#include "kinematics/rod/conditions.h"

#include "core/linear_algebra.h"

namespace flextip {

void FillTipStretch(const RodMap& map, RodPlace& place) {
  place.uv.setZero();
  place.dP.setZero();
  place.uv.middleCols<2>(kTurn) = map.flow.leftCols<2>();
  place.dP.middleCols<2>(kTurn) = map.way.leftCols<2>();
  place.uv.middleCols<3>(kForce) = map.FlowByForce();
  place.dP.middleCols<3>(kForce) = map.way_by_force;
}

void FillWristStretch(const RodMap& map, const RodPlace& port, const Eigen::Vector3d& r,
                      RodPlace& place) {
  Eigen::Matrix<double, 4, kRodColumns> start = port.uv;
  start.block<2, 1>(2, kPlace) += port.Across().transpose() * r;
  place.uv = map.flow * start;
  place.dP = port.dP + map.way * start;
  const Eigen::Matrix<double, 4, 3> by_force = map.FlowByForce();
  for (const int first : {kReaction, kForce}) {
    place.uv.middleCols<3>(first) += by_force;
    place.dP.middleCols<3>(first) += map.way_by_force;
  }
}

void RodSolver::Evaluate(const Scaled& scaled, const Unknowns& x, bool with_derivatives,
                         Evaluation& e) {
  RodMap tip_stretch, wrist_stretch;
  e.ok = false;
  RodPoint point{x.t_tip, x.y_tip};
  if (!Advance(x.sigma_port, {scaled.f, scaled.q}, point,
               with_derivatives ? &tip_stretch : nullptr)) {
    return;
  }
  static_cast<RodPoint&>(e.port) = point;
  e.n_beyond = scaled.f + x.sigma_port * scaled.q;
  if (!Advance(1.0 - x.sigma_port, {e.n_beyond + x.r, scaled.q}, point,
               with_derivatives ? &wrist_stretch : nullptr)) {
    return;
  }
  static_cast<RodPoint&>(e.wrist) = point;
  e.residual.head<3>() = e.wrist.P - e.port.P - scaled.span;
  e.residual.segment<2>(3) = e.wrist.Across().transpose() * e.wrist.m;
  e.residual[5] = x.r.dot(e.port.t);
  e.ok = e.residual.allFinite();
  if (!e.ok || !with_derivatives) return;
  e.Differentiate(tip_stretch, wrist_stretch, x);
  e.ok = e.derivative.allFinite();
}

/// Fills `derivative` and `inverse`.
void RodSolver::Evaluation::Differentiate(const RodMap& tip_stretch, const RodMap& wrist_stretch,
                                          const Unknowns& x) {
  FillTipStretch(tip_stretch, port);
  FillWristStretch(wrist_stretch, port, x.r, wrist);
  derivative.topRows<3>() = wrist.dP - port.dP;
  derivative.block<3, 1>(0, kPlace) -= port.t;
  derivative.row(3) = wrist.uv.row(3);
  derivative.row(4) = -wrist.uv.row(2);
  derivative.row(5) = (x.r.transpose() * port.Across()) * port.uv.topRows<2>();
  derivative(5, kPlace) += x.r.dot(port.t.cross(port.m));
  derivative.block<1, 3>(5, kReaction) += port.t.transpose();
  inverse = Lu(derivative.leftCols<6>()).Inverse();
}

/// Changes the inverse by as little as makes it right along the last step (Broyden).
void RodSolver::Evaluation::Learn(const Vector6& dx, const Vector6& change) {
  const Vector6 seen = inverse * change;
  const double size = dx.dot(seen);
  if (!(std::abs(size) > 0.1 * dx.squaredNorm())) return;
  inverse += ((dx - seen) / size) * (dx.transpose() * inverse).eval();
}

/// Moves the states with the unknowns to first order. The rest is of the order of the squared
/// correction, below rounding where the residual is below kNearlyThere.
void RodSolver::Evaluation::Correct(const Vector6& dx) {
  for (RodPlace* place : {&port, &wrist}) {
    const Eigen::Matrix<double, 4, 1> uv = place->uv.leftCols<6>() * dx;
    // The port's place moves along the shaft as well.
    const double along = place == &port ? dx[kPlace] : 0.0;
    const Eigen::Vector3d t = place->t, m = place->m;
    place->t += place->Across() * uv.head<2>() + along * t.cross(m);
    place->m += RodPoint{t, place->y, m}.MomentChange<1>(uv) + along * t.cross(n_beyond);
    place->P += place->dP.leftCols<6>() * dx + along * t;
    place->MakeOrthonormal();
  }
  residual += derivative.leftCols<6>() * dx;
}

void RodSolver::Unknowns::Move(const Vector6& dx) {
  RodPoint tip{t_tip, y_tip};
  tip.t += tip.Across() * dx.head<2>();
  tip.MakeOrthonormal();
  t_tip = tip.t;
  y_tip = tip.y;
  sigma_port += dx[kPlace];
  r += dx.tail<3>();
}

}  // namespace flextip
