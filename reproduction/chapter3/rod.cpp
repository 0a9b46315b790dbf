#include "reproduction/chapter3/rod.h"

#include <cmath>

#include "core/check.h"
#include "kinematics/rod.h"

namespace flextip::reproduction {

PlaneRodState PlaneRodAt(const BentShaft& shaft, double distance_m) {
  const double L = shaft.length_m;
  RodProblem problem{L, 1.0, {0, 0, 0}, {distance_m, 0, 0}, {0, -shaft.F_t_over_EI, 0}, {0, 0, 0}};
  RodSolver solver;
  RodState rod = solver.Solve(problem);
  for (int i = 0; i < 50 && rod.IsUsable(); ++i) {  // the force turns with the chord
    const Eigen::Vector3d chord = rod.tip.p.normalized();
    const Eigen::Vector3d f = shaft.F_t_over_EI * Eigen::Vector3d(chord.y(), -chord.x(), 0.0);
    const double change = (f - problem.f_tip).norm();
    problem.f_tip = f;
    rod = solver.Solve(problem);
    if (change < 1e-12) break;
  }
  FLEXTIP_CHECK(rod.IsUsable(), "a solved rod");
  PlaneRodState state;
  state.depth_m = (rod.tip.p - problem.p_port).norm();
  state.readings << 0.0, 0.0, rod.tip.p.x(), rod.tip.p.y(),
      std::atan2(rod.wrist.t.y(), rod.wrist.t.x()), std::atan2(rod.tip.t.y(), rod.tip.t.x());
  state.J_tip_wrist = rod.J_tip_wrist().topLeftCorner<2, 2>();
  state.lever.length_m = L;
  state.lever.a = distance_m;
  return state;
}

}  // namespace flextip::reproduction
