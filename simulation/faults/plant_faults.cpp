#include "simulation/faults/plant_faults.h"

#include <algorithm>
#include <random>

namespace flextip::simulation {
namespace {

constexpr double kRamp_s = 0.1;

/// Part of the fault that is there: it comes and goes evenly.
double Part(const Fault& fault, double t_s) {
  const double end_s = fault.start_s + fault.duration_s;
  const double in = (t_s - fault.start_s) / kRamp_s, out = (end_s - t_s) / kRamp_s;
  return std::clamp(std::min(in, out + 1.0), 0.0, 1.0);
}

void Weaken(double part, TipLoad& load) {
  load.constant_N *= 1.0 - part;
  if (load.tissue) {
    load.tissue->stiffness_N_m *= 1.0 - part;
    load.tissue->tangential_stiffness_N_m *= 1.0 - part;
  }
  if (!load.other) return;
  load.other = [law = load.other, part](const Eigen::Vector3d& p_tip) {
    LinearTipForce force = law(p_tip);
    force.f_N *= 1.0 - part;
    force.df_dp_N_m *= 1.0 - part;
    return force;
  };
}

void Hold(const Eigen::Vector3d& p_caught, double stiffness_N_m, TipLoad& load) {
  load.other = [law = load.other, p_caught, stiffness_N_m](const Eigen::Vector3d& p_tip) {
    LinearTipForce force = law ? law(p_tip) : LinearTipForce();
    force.f_N += stiffness_N_m * (p_caught - p_tip);
    force.df_dp_N_m -= stiffness_N_m * Eigen::Matrix3d::Identity();
    return force;
  };
}

}  // namespace

PlantFaults::PlantFaults(const std::vector<Fault>& faults, const PlantSetup& setup,
                         std::uint64_t seed)
    : load_(setup.load), effects_(setup.effects) {
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (faults[i].stream != FaultStream::kPlant && faults[i].kind != FaultKind::kEncoderSlip)
      continue;
    std::mt19937_64 rng(FaultSeed(seed, i));
    std::normal_distribution<double> normal;
    OneFault one;
    one.fault = faults[i];
    for (double& x : one.direction) x = normal(rng);
    one.direction.normalize();
    faults_.push_back(std::move(one));
  }
}

void PlantFaults::Act(double t_s, const PlantShape& last, Plant& plant) {
  if (faults_.empty()) return;
  PlantEffects effects = effects_;
  TipLoad load = load_;
  for (OneFault& one : faults_) Change(t_s, last, one, effects, load);
  plant.SetEffects(effects);
  plant.SetLoad(load);
}

void PlantFaults::Change(double t_s, const PlantShape& last, OneFault& one, PlantEffects& effects,
                         TipLoad& load) {
  const Fault& fault = one.fault;
  const double part = Part(fault, t_s);
  switch (fault.kind) {
    case FaultKind::kPortMoved:
      effects.port_offset_m += part * fault.size * one.direction;
      break;
    case FaultKind::kTissueLetsGo:
      if (fault.IsActive(t_s)) Weaken(fault.size, load);
      break;
    case FaultKind::kTipCaught:
      if (!fault.IsActive(t_s)) break;
      if (!one.p_caught) one.p_caught = last.T_RE().p;
      Hold(*one.p_caught, fault.size, load);
      break;
    case FaultKind::kShaftGrasped: {
      if (part == 0.0) break;
      const Eigen::Vector3d& t = last.t_port;
      if (!one.grasp) one.grasp = (one.direction - t.dot(one.direction) * t).normalized();
      effects.shaft_load_N_m += part * fault.size * *one.grasp;
      break;
    }
    default:
      break;  // the encoders' slip: WristShift
  }
}

Eigen::Vector3d PlantFaults::WristShift(double t_s) const {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const OneFault& one : faults_) {
    if (one.fault.kind == FaultKind::kEncoderSlip && t_s >= one.fault.start_s)
      shift += one.fault.size * one.direction;
  }
  return shift;
}

}  // namespace flextip::simulation
