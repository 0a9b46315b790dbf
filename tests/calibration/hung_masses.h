// Recordings of the simulated plant with masses hung on its tip: an instrument that shares no
// solver with the models in kinematics/.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "recording/recording.h"
#include "simulation/plant/effects.h"
#include "simulation/plant/shape.h"

namespace flextip::test_support {

struct HungMass {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  Eigen::Vector3d f_N = Eigen::Vector3d::Zero();
  double roll_rad = 0.0;
};

struct BenchNoise {
  double wrist_m = 5e-5, wrist_rad = 5e-4, force_N = 0.002, port_m = 3e-4;
  double reading = 0.0;  ///< of strain0, in its units
  double tip_m = 1e-4, direction_rad = 2e-3, em_m = 2e-4, em_rad = 1e-3;
};

struct Bench {
  Instrument instrument{0.6, 0.00238, 0.304, 0.0};
  Eigen::Vector3d p_RP{0.28, 0.0, 0.0};  ///< the true one
  simulation::PlantEffects effects;
  int samples = 10;                                     ///< in each hold
  Eigen::Matrix4d gains = Eigen::Matrix4d::Identity();  ///< readings per Nm
  Eigen::Vector4d offset = Eigen::Vector4d::Zero();     ///< readings
  double em_from_tip_m = 0.02;
  BenchNoise noise;
};

/// The plant's equilibria, one a mass.
std::vector<simulation::PlantShape> Hang(const Bench& bench, const std::vector<HungMass>& masses);

/// What the sensors say of them: wrist0, load0 (stated once a hold), strain0, vision0 and em0, with
/// noise of `seed`, and a port that is registered as badly as stated.
Recording RecordBench(const Bench& bench, const std::vector<HungMass>& masses,
                      const std::vector<simulation::PlantShape>& shapes, std::uint64_t seed);

/// Both masses each way across the shaft at each wrist place along x, and the unloaded shaft.
std::vector<HungMass> AllWays(const std::vector<double>& wrist_x_m,
                              const std::vector<double>& forces_N);

}  // namespace flextip::test_support
