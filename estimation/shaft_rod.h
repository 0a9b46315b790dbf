// The rod with whatever acts on it, by the plain solver where nothing else does (it is several
// times faster): one answer for estimation and control.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <span>

#include "estimation/shaft_model.h"
#include "kinematics/effect_rod.h"
#include "kinematics/rod.h"

namespace flextip {

/// Returns whether `effects` leave the rod plain (y_wrist alone does nothing).
bool IsPlain(const RodEffects& effects);

struct ShaftProblem {
  EffectRodProblem rod;
  double tip_compliance_m_N = 0.0;
};

/// Returns the rod of `model` with the wrist measured at `p_RW` (R, m).
ShaftProblem RodOf(const ShaftModel& model, const Eigen::Vector3d& p_RW);

/// A place on the shaft: the instrument's y axis there and its derivative beside the rest.
struct ShaftSection : RodSection {
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  RodDerivative dy = RodDerivative::Zero();
};

inline constexpr int kMaxShaftStations = 3;

struct ShaftRodState {
  RodStatus status = RodStatus::kNotConverged;
  bool has_axes = false;  ///< y and dy of the sections are there: the rod is not plain
  ShaftSection wrist;     ///< where it truly is
  ShaftSection end;       ///< of the shaft
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();  ///< the tip: the end and its yield there
  RodDerivative dp_RE = RodDerivative::Zero();
  std::array<ShaftSection, kMaxShaftStations> stations;
  double s_port_m = 0.0;
  Eigen::Vector3d t_port = Eigen::Vector3d::UnitX();
  RodDerivative dt_port = RodDerivative::Zero();

  bool IsUsable() const { return status == RodStatus::kOk; }
};

/// Allocates nothing; starts from the last equilibrium.
class ShaftRod {
 public:
  /// Solves for at most kMaxShaftStations `stations`; a station beyond an end of the shaft is that
  /// end.
  ShaftRodState Solve(const ShaftProblem& problem, std::span<const RodStation> stations = {});

  void Reset();

  void VisitState(StateText& state) {
    state(plain_);
    state(effects_);
  }

 private:
  ShaftRodState SolvePlain(const RodProblem& problem, std::span<const RodStation> stations);
  ShaftRodState SolveEffects(const EffectRodProblem& problem, std::span<const RodStation> stations);

  RodSolver plain_;
  EffectRodSolver effects_;
};

}  // namespace flextip
