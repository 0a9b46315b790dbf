// Faults that happen to the instrument: in the plant, while it runs.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/faults/fault.h"
#include "simulation/plant/plant.h"

namespace flextip::simulation {

class PlantFaults {
 public:
  /// Takes those of `faults` that are of the plant, and encoders that slip. `setup`: the plant
  /// without fault.
  PlantFaults(const std::vector<Fault>& faults, const PlantSetup& setup, std::uint64_t seed);

  /// Makes `plant` what it is at `t_s`, before it is solved there. `last`: its last equilibrium.
  /// What moves comes and goes within 0.1 s; tissue lets go and the tip is caught at once.
  void Act(double t_s, const PlantShape& last, Plant& plant);

  /// Returns how far the true wrist is from the encoders' (m, in R) at `t_s`.
  Eigen::Vector3d WristShift(double t_s) const;

 private:
  struct OneFault {
    Fault fault;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit
    std::optional<Eigen::Vector3d> p_caught;               // of the tip
    std::optional<Eigen::Vector3d> grasp;                  // unit, across the shaft
  };
  static void Change(double t_s, const PlantShape& last, OneFault& one, PlantEffects& effects,
                     TipLoad& load);

  std::vector<OneFault> faults_;
  TipLoad load_;
  PlantEffects effects_;
};

}  // namespace flextip::simulation
