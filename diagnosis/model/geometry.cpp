#include "diagnosis/model/geometry.h"

#include <cmath>

namespace flextip::diagnosis {
namespace {

constexpr double kAtTip_m = 1e-6;  // an EM sensor this near to the tip is at the tip

EffectRodProblem MakeProblem(const SampleSet& samples, std::size_t k, const SampleInputs& u,
                             const Eigen::Vector3d& f_tip_N) {
  using namespace sample_input;
  const DiagnosisSample& sample = samples.samples[k];
  EffectRodProblem problem;
  RodProblem& rod = problem.rod;
  rod.length_m = samples.instrument.length_m + u[kLength];
  rod.bending_stiffness_Nm2 = samples.instrument.bending_stiffness_Nm2 * std::exp(u[kStiffness]);
  rod.stiffness_taper = samples.instrument.stiffness_taper;
  rod.p_wrist = sample.p_RW + u.segment<3>(kWrist);
  rod.p_port = samples.p_RP + u.segment<3>(kPort);
  rod.f_tip = f_tip_N;
  rod.q_weight =
      samples.instrument.mass_per_length_kg_m * samples.gravity_m_s2 + u.segment<3>(kWeight);
  problem.effects = EffectsOf(u, sample.y_wrist);
  return problem;
}

/// A moment's parts along the section's own y and z axes.
void FillMoments(const EffectRodSection& s, int first, SolvedSample& solved) {
  const Eigen::Vector3d z = s.t.cross(s.y);
  solved.at[first] = s.m.dot(s.y);
  solved.at[first + 1] = s.m.dot(z);
  solved.by_inputs.row(first) = s.y.transpose() * s.dm + s.m.transpose() * s.dy;
  // m . d(t x y) = (y x m) . dt + (m x t) . dy
  solved.by_inputs.row(first + 1) =
      z.transpose() * s.dm + s.y.cross(s.m).transpose() * s.dt + s.m.cross(s.t).transpose() * s.dy;
}

void Fill(const Eigen::Vector3d& value, const InputDerivative& derivative, int first,
          SolvedSample& solved) {
  solved.at.segment<3>(first) = value;
  solved.by_inputs.middleRows<3>(first) = derivative;
}

}  // namespace

RodEffects EffectsOf(const SampleInputs& u, const Eigen::Vector3d& y_wrist) {
  using namespace sample_input;
  RodEffects effects;
  effects.y_wrist = y_wrist;
  effects.curvature_1_m = u.segment<2>(kCurvature);
  effects.port_compliance_m_N = u[kPortCompliance];
  effects.wrist_compliance_m_N = u[kWristCompliance];
  effects.port_couple_Nm = u.segment<3>(kPortCouple);
  effects.port_friction = u[kPortFriction];
  effects.q_inside_N_m = u.segment<3>(kInside);
  return effects;
}

SolvedSample SolveSample(const SampleSet& samples, std::size_t k, const SampleInputs& inputs,
                         const Eigen::Vector3d& f_tip_N, EffectRodSolver& solver) {
  RodStation stations[3];
  int count = 0, em = -1, strain = -1;
  if (samples.has_em && samples.em_from_tip_m > kAtTip_m) {
    em = count;
    stations[count++] = {samples.em_from_tip_m, true};
  }
  if (samples.has_strain) {
    strain = count;
    for (const double s_m : samples.strain_from_wrist_m) stations[count++] = {s_m, false};
  }
  const EffectRodState rod = solver.Solve(MakeProblem(samples, k, inputs, f_tip_N),
                                          {stations, static_cast<std::size_t>(count)});
  SolvedSample solved;
  solved.ok = rod.IsUsable();
  if (!solved.ok) return solved;
  const EffectRodSection& em_section = em >= 0 ? rod.stations[em] : rod.tip;
  Fill(em_section.p, em_section.dp, place::kEm, solved);
  Fill(em_section.t, em_section.dt, place::kEmTangent, solved);
  Fill(rod.tip.p, rod.tip.dp, place::kTip, solved);
  Fill(rod.tip.t, rod.tip.dt, place::kTipTangent, solved);
  Fill(rod.tip.y, rod.tip.dy, place::kTipY, solved);
  Fill(rod.wrist.t, rod.wrist.dt, place::kWristTangent, solved);
  Fill(rod.t_port, rod.dt_port, place::kPortTangent, solved);
  if (strain >= 0) {
    FillMoments(rod.stations[strain], place::kMoments, solved);
    FillMoments(rod.stations[strain + 1], place::kMoments + 2, solved);
  }
  solved.s_port_m = rod.s_port_m;
  solved.ds_port_dfriction_m = rod.ds_port[rod_input::kPortFriction];
  solved.lateral_force_N = (rod.f_port - rod.f_port.dot(rod.t_port) * rod.t_port).norm();
  return solved;
}

}  // namespace flextip::diagnosis
