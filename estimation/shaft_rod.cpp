#include "estimation/shaft_rod.h"

#include <algorithm>

#include "core/check.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kEnd_m = 1e-7;  // a station this near to an end is at the end

ShaftSection WithoutAxes(const RodSection& section) {
  ShaftSection s;
  static_cast<RodSection&>(s) = section;
  return s;
}

ShaftSection WithAxes(const EffectRodSection& section) {
  ShaftSection s;
  s.s_m = section.s_m;
  s.p = section.p;
  s.t = section.t;
  s.m = section.m;
  s.y = section.y;
  s.dp = section.dp.leftCols<9>();
  s.dt = section.dt.leftCols<9>();
  s.dm = section.dm.leftCols<9>();
  s.dy = section.dy.leftCols<9>();
  return s;
}

double FromWrist(const RodStation& station, double length_m) {
  return std::clamp(station.from_tip ? length_m - station.s_m : station.s_m, 0.0, length_m);
}

}  // namespace

ShaftProblem RodOf(const ShaftModel& model, const Eigen::Vector3d& p_RW) {
  ShaftProblem problem;
  problem.rod.rod = {model.instrument.length_m,
                     model.instrument.bending_stiffness_Nm2,
                     p_RW + model.wrist_shift_m,
                     model.p_RP,
                     model.f_tip_N,
                     model.weight_N_m,
                     model.instrument.stiffness_taper};
  problem.rod.effects = model.effects;
  problem.tip_compliance_m_N = model.tip_compliance_m_N;
  return problem;
}

bool IsPlain(const RodEffects& e) {
  return e.curvature_1_m.isZero(0.0) && e.port_compliance_m_N == 0.0 &&
         e.wrist_compliance_m_N == 0.0 && e.port_couple_Nm.isZero(0.0) && e.port_friction == 0.0 &&
         e.q_inside_N_m.isZero(0.0);
}

ShaftRodState ShaftRod::Solve(const ShaftProblem& problem, std::span<const RodStation> stations) {
  FLEXTIP_CHECK(stations.size() <= kMaxShaftStations, "the stations fit their array");
  const RodProblem& rod = problem.rod.rod;
  ShaftRodState state;
  if (!IsPlain(problem.rod.effects)) {
    state = SolveEffects(problem.rod, stations);
  } else if (rod.stiffness_taper != 0) {
    EffectRodProblem tapered{.rod = rod, .effects = {}};
    tapered.effects.y_wrist = NormalBasis((rod.p_port - rod.p_wrist).normalized()).col(0);
    state = SolveEffects(tapered, stations);
    state.has_axes = false;  // these are arbitrary ones
  } else {
    state = SolvePlain(rod, stations);
  }
  state.p_RE = state.end.p + problem.tip_compliance_m_N * problem.rod.rod.f_tip;
  state.dp_RE = state.end.dp;
  state.dp_RE.rightCols<3>() += problem.tip_compliance_m_N * Eigen::Matrix3d::Identity();
  return state;
}

ShaftRodState ShaftRod::SolvePlain(const RodProblem& problem,
                                   std::span<const RodStation> stations) {
  const RodState rod = plain_.Solve(problem);
  ShaftRodState state;
  state.status = rod.status;
  if (!rod.IsUsable()) return state;
  state.wrist = WithoutAxes(rod.wrist);
  state.end = WithoutAxes(rod.tip);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    state.stations[i] = WithoutAxes(plain_.Section(FromWrist(stations[i], problem.length_m)));
  }
  state.s_port_m = rod.s_port_m;
  state.t_port = rod.t_port;
  state.dt_port = rod.dt_port;
  return state;
}

ShaftRodState ShaftRod::SolveEffects(const EffectRodProblem& problem,
                                     std::span<const RodStation> stations) {
  const double length = problem.rod.length_m;
  std::array<RodStation, kMaxShaftStations> inside;
  std::array<int, kMaxShaftStations> place{};  // among those inside; -1 wrist, -2 end
  std::size_t count = 0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const double s = FromWrist(stations[i], length);
    place[i] = s < kEnd_m ? -1 : s > length - kEnd_m ? -2 : static_cast<int>(count);
    if (place[i] >= 0) inside[count++] = {s, false};
  }
  const EffectRodState rod = effects_.Solve(problem, {inside.data(), count});
  ShaftRodState state;
  state.status = rod.status;
  if (!rod.IsUsable()) return state;
  state.has_axes = true;
  state.wrist = WithAxes(rod.wrist);
  state.end = WithAxes(rod.tip);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    state.stations[i] = place[i] == -1   ? state.wrist
                        : place[i] == -2 ? state.end
                                         : WithAxes(rod.stations[place[i]]);
  }
  state.s_port_m = rod.s_port_m;
  state.t_port = rod.t_port;
  state.dt_port = rod.dt_port.leftCols<9>();
  return state;
}

void ShaftRod::Reset() {
  plain_.Reset();
  effects_.Reset();
}

}  // namespace flextip
