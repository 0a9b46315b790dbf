// The simulated instrument: a shaft pinned at the wrist, sliding through a frictionless port and
// loaded at the tip and by its weight. Its equilibrium is the minimum of a discrete elastic chain's
// energy (chain.h), a method of its own: nothing here is shared with the models in kinematics/.
#pragma once

#include <Eigen/Dense>

#include "core/instrument.h"
#include "simulation/chain.h"
#include "simulation/plant_shape.h"
#include "simulation/tip_load.h"

namespace flextip {

/// What the plant is made of. Everything in R.
struct PlantSetup {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();        ///< port
  Eigen::Vector3d weight_N_m = Eigen::Vector3d::Zero();  ///< on the shaft, per length
  TipLoad load;
  double roll_rad = 0.0;  ///< of the instrument about its own axis at the wrist
};

struct PlantOptions {
  int links_before_port = 100;  ///< at least 4; the error falls with the square
  int links_behind_port = 100;
};

/// Finds one equilibrium after the other and starts each from the last.
class Plant {
 public:
  explicit Plant(const PlantSetup& setup, const PlantOptions& options = {});

  /// The equilibrium with the wrist at `p_RW`: from the last one where there is one, otherwise
  /// from the straight shaft with the load applied in steps.
  PlantShape Solve(const Eigen::Vector3d& p_RW);

  const PlantSetup& Setup() const { return setup_; }
  /// Changes the load; the next solve starts from the shape under the old one.
  void SetLoad(const TipLoad& load) { setup_.load = load; }

 private:
  ChainState Straight(const ChainProblem& problem) const;
  bool SolveCold(const Eigen::Vector3d& p_RW, ChainState& state, int& iterations) const;
  ChainProblem Problem(const Eigen::Vector3d& p_RW, double load_fraction) const;
  void FillShape(const Eigen::Vector3d& p_RW, PlantShape& shape) const;

  PlantSetup setup_;
  PlantOptions options_;
  bool warm_ = false;
  ChainState state_;
};

}  // namespace flextip
