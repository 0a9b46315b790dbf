// Uses the installed headers and libraries: a shaft's equilibrium, a step of a controller, a page.
#include <flextip/control/controller.h>
#include <flextip/core/version.h>
#include <flextip/kinematics/rod.h>
#include <flextip/report/report.h>

#include <cstdio>

int main() {
  flextip::RodProblem problem;
  problem.length_m = 0.6;
  problem.bending_stiffness_Nm2 = 0.304;
  problem.p_port = {0.28, 0.0, 0.0};
  problem.f_tip = {0.0, 0.5, 0.0};
  flextip::RodSolver solver;
  const flextip::RodState rod = solver.Solve(problem);
  if (!rod.IsUsable()) return 1;

  flextip::ControlInput input;
  input.p_RE_desired = rod.tip.p + Eigen::Vector3d(0.0, 0.001, 0.0);
  input.p_RE_measured = rod.tip.p;
  input.tip_measured = true;
  input.model.instrument = {0.6, 0.00238, 0.304, 0.0};
  input.model.p_RP = problem.p_port;
  input.model.f_tip_N = problem.f_tip;
  input.model.force_known = true;
  flextip::TipController controller({});
  const flextip::ControlOutput output = controller.Step(input);
  if (output.status != flextip::ControlStatus::kOk) return 2;

  flextip::report::Report report("consumer");
  if (report.Html().find("consumer") == std::string::npos) return 3;
  std::printf("flextip %s: tip at %.4f %.4f %.4f m\n", flextip::kVersion, rod.tip.p.x(),
              rod.tip.p.y(), rod.tip.p.z());
  return 0;
}
