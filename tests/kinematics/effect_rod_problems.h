// Random problems of the rod with effects, and problems made from their 25 inputs.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "kinematics/effect_rod.h"

namespace flextip {

/// The inputs in the order of rod_input.
inline Eigen::VectorXd InputsOf(const EffectRodProblem& problem) {
  Eigen::VectorXd u(rod_input::kCount);
  u << problem.rod.p_wrist, problem.rod.p_port, problem.rod.f_tip,
      std::log(problem.rod.bending_stiffness_Nm2), problem.rod.length_m, problem.rod.q_weight,
      problem.effects.curvature_1_m, problem.effects.port_compliance_m_N,
      problem.effects.wrist_compliance_m_N, problem.effects.port_couple_Nm,
      problem.effects.port_friction, problem.effects.q_inside_N_m;
  return u;
}

inline EffectRodProblem WithInputs(EffectRodProblem problem, const Eigen::VectorXd& u) {
  problem.rod.p_wrist = u.segment<3>(rod_input::kWrist);
  problem.rod.p_port = u.segment<3>(rod_input::kPort);
  problem.rod.f_tip = u.segment<3>(rod_input::kForce);
  problem.rod.bending_stiffness_Nm2 = std::exp(u[rod_input::kStiffness]);
  problem.rod.length_m = u[rod_input::kLength];
  problem.rod.q_weight = u.segment<3>(rod_input::kWeight);
  problem.effects.curvature_1_m = u.segment<2>(rod_input::kCurvature);
  problem.effects.port_compliance_m_N = u[rod_input::kPortCompliance];
  problem.effects.wrist_compliance_m_N = u[rod_input::kWristCompliance];
  problem.effects.port_couple_Nm = u.segment<3>(rod_input::kPortCouple);
  problem.effects.port_friction = u[rod_input::kPortFriction];
  problem.effects.q_inside_N_m = u.segment<3>(rod_input::kInside);
  return problem;
}

/// Every effect at once, each of a size that shows; loads up to f L^2/EI = 2.
inline std::vector<EffectRodProblem> RandomEffectProblems(int count, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] {
    Eigen::Vector3d v;
    do {
      v << uniform(rng), uniform(rng), uniform(rng);
    } while (v.norm() > 1.0 || v.norm() < 0.1);
    return v;
  };
  std::vector<EffectRodProblem> problems;
  while (static_cast<int>(problems.size()) < count) {
    EffectRodProblem p;
    const double L = p.rod.length_m = 0.45 + 0.15 * uniform(rng);
    const double EI = p.rod.bending_stiffness_Nm2 = 0.4 + 0.3 * uniform(rng);
    p.rod.p_wrist = 0.1 * vector();
    const Eigen::Vector3d along = vector().normalized();
    p.rod.p_port = p.rod.p_wrist + L * (0.57 + 0.2 * uniform(rng)) * along;
    p.rod.f_tip = 2.0 * EI / (L * L) * vector();
    p.rod.q_weight = 0.4 * EI / (L * L * L) * vector();
    p.effects.y_wrist = vector();
    p.effects.curvature_1_m << 0.3 / L * uniform(rng), 0.3 / L * uniform(rng);
    p.effects.port_compliance_m_N = 0.01 * (1.0 + uniform(rng)) * L * L * L / EI;
    p.effects.wrist_compliance_m_N = 0.005 * (1.0 + uniform(rng)) * L * L * L / EI;
    p.effects.port_couple_Nm = 0.3 * EI / L * vector();
    p.effects.port_friction = 0.3 * uniform(rng);
    p.effects.q_inside_N_m = 0.5 * EI / (L * L * L) * vector();
    const Eigen::Vector3d span = (p.rod.p_port - p.rod.p_wrist).normalized();
    if (p.effects.y_wrist.normalized().cross(span).norm() < 0.2) continue;
    problems.push_back(p);
  }
  return problems;
}

}  // namespace flextip
