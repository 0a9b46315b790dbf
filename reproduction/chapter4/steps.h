// Moves by quasi-static steps (4.3.1, and 4.3.2's first set): plant, sensors' noise, the loop.
// Private to reproduction. The plane is x-y, y up; z is zero.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "kinematics/plane_beam.h"
#include "reproduction/chapter4/controllers.h"
#include "simulation/plant/plant.h"

namespace flextip::reproduction {

/// What the sensors are on: wrist and tip, and the shaft's directions there and at the port.
struct Ch4Shape {
  Eigen::Vector3d p_RW, p_RE;
  Eigen::Vector3d t_wrist, t_port, t_tip;  // unit
};

/// A shaft under a constant force: as 4.3.1 has it, by the beam itself, or exactly.
class Ch4Plant {
 public:
  static Ch4Plant Beam(const Instrument& instrument, const Eigen::Vector3d& p_RP, double f_tip_N);
  /// `overhang_m`: unloaded shaft beyond where the force acts; its end is the tip.
  static Ch4Plant Exact(const simulation::PlantSetup& setup, double overhang_m = 0.0) {
    return Ch4Plant(setup, overhang_m);
  }

  /// Empty where there is no equilibrium.
  std::optional<Ch4Shape> At(const Eigen::Vector3d& p_RW);

 private:
  explicit Ch4Plant(const PlaneBeamProblem& beam) : beam_(beam) {}
  Ch4Plant(const simulation::PlantSetup& setup, double overhang_m)
      : exact_(setup), overhang_m_(overhang_m) {}

  PlaneBeamProblem beam_;
  std::optional<simulation::Plant> exact_;
  double overhang_m_ = 0.0;
};

/// Of wrist and tip positions (each axis) and of the three angles.
struct Ch4Noise {
  bool uniform = true;  ///< the figures are the largest magnitudes; else standard deviations
  double position_m = 0.0, angle_rad = 0.0;
  bool tip_too =
      true;         ///< false: noise only in the data of the model's fit, none in the tip's error
  int samples = 1;  ///< averaged for one update
};

/// The sensors' values, with their noise stated as standard deviations.
Measurements Ch4Sense(const Ch4Shape& shape, const Ch4Noise& noise, std::mt19937_64& rng);

struct Ch4Move {
  Ch4Kind kind = Ch4Kind::kStraight;
  Ch4Setup setup;
  Eigen::Vector3d p_RW_start = Eigen::Vector3d::Zero();
  Eigen::Vector3d move_m = Eigen::Vector3d::Zero();
  Ch4Noise noise;
  double step_m = 0.002;
  double reached_m = 5e-5;  ///< the tip as known, from its goal
  int most_updates = 20;
  std::uint64_t seed = 0;
};

struct Ch4Run {
  std::vector<Eigen::Vector3d> p_RE, p_RE_measured;  ///< the start and after each update
  double max_m = 0.0;                                ///< the true tip from the straight path
  double max_measured_m = 0.0;                       ///< the same for the measured tip
  int updates = 0;
  bool lost = false;  ///< the shaft lost its equilibrium
};

/// The stop logic of 4.3.1: the goal moves on by a step each update up to the move's end and stays
/// there until the tip is known to have reached it. `plant` is at the start's equilibrium.
Ch4Run RunCh4Move(const Ch4Move& move, Ch4Plant plant);

}  // namespace flextip::reproduction
