// The parts of the plant, and its chain.
#pragma once

#include <Eigen/Dense>

#include "core/instrument.h"
#include "simulation/plant/chain_problem.h"
#include "simulation/plant/effects.h"
#include "simulation/tissue/tip_load.h"

namespace flextip::simulation {

/// Everything in R.
struct PlantSetup {
  Instrument instrument;                                 ///< nominal
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();        ///< port, as registered
  Eigen::Vector3d weight_N_m = Eigen::Vector3d::Zero();  ///< nominal, on the shaft, per length
  TipLoad load;
  double roll_rad = 0.0;  ///< of the instrument about its own axis at the wrist
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};  ///< acts on the effects' mass only
  PlantEffects effects;
  /// Torsional over bending stiffness, 1 / (1 + Poisson's ratio) of a tube. Only a shaft that is
  /// bent when unloaded has torsion.
  double torsion = 1.0 / 1.3;
};

struct PlantOptions {
  int links_before_port = 100;  ///< at least 4; the error falls with the square
  int links_behind_port = 100;
};

/// The units of the chain: the true shaft's length, and its stiffness over the square of it.
struct PlantUnits {
  explicit PlantUnits(const PlantSetup& setup);
  double length_m, stiffness_Nm2, force_N, moment_Nm;
};

/// Returns the place of the port's centre at `t_s` without force (m, in R).
Eigen::Vector3d PortAt(const PlantSetup& setup, double t_s);

/// Returns the reason why there can be no such plant; empty where there can.
const char* WhatIsWrong(const PlantSetup& setup);

/// Returns the chain with the wrist held at `p_RW`, with `fraction` of all loads and deformations,
/// without friction and without tissue on the shaft, which have a memory. Refers to `setup`.
ChainProblem MakeChain(const PlantSetup& setup, const PlantOptions& options,
                       const Eigen::Vector3d& p_RW, double t_s, double fraction);

}  // namespace flextip::simulation
