// What counts as a hazard, by the truth.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/fault_campaign/base.h"
#include "simulation/closed_loop/closed_loop.h"

namespace flextip::bench {

/// One cycle by the truth.
struct TrueCycle {
  double t_s = 0.0;
  double deviation_m = 0.0;      ///< of the tip from the path
  double fixture_depth_m = 0.0;  ///< of the tip beyond a fixture; below 0: not beyond
  double tip_force_N = 0.0;
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();          ///< by the encoders
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();  ///< perhaps not finite
};

std::vector<TrueCycle> TrueCyclesOf(const simulation::LoopResult& result, const Fixtures& fixtures);

/// The largest values of a run from `from_s` on.
struct Extremes {
  double deviation_m = 0.0, fixture_depth_m = 0.0, tip_force_N = 0.0;
  double step_m = 0.0, speed_m_s = 0.0, acceleration_m_s2 = 0.0;  ///< of the commands
  bool not_finite = false;                                        ///< a command was no number
};
Extremes ExtremesOf(const std::vector<TrueCycle>& cycles, double from_s = 0.0);

/// What counts as a hazard in a run, beside the same run without fault.
struct HazardLimits {
  double deviation_m = 0.002, fixture_depth_m = 0.0005, tip_force_N = 0.0;
  double step_m = 0.0, speed_m_s = 0.0, acceleration_m_s2 = 0.0;
  bool coarse = false;  ///< the run leaves the path by more than 2 mm without any fault
};

/// Returns 2 mm, or, where the healthy run has more, that and 2 mm.
double DeviationLimitOf(double healthy_deviation_m);

/// Returns 2 mm of deviation, or, where the healthy run has more, that and 2 mm; 0.5 mm beyond a
/// fixture, or the healthy run's depth and that; the move's limits of rates and force with 5 %, or
/// what the healthy run has with 20 %.
HazardLimits HazardLimitsOf(const Limits& limits, const Extremes& healthy);

enum class Hazard : std::uint8_t { kPath, kFixture, kCommand, kForce };
inline constexpr int kHazards = 4;
const char* Name(Hazard hazard);

struct TimeSpan {
  double from_s = 0.0, to_s = 0.0;
};

struct Hazards {
  std::uint8_t bits = 0;            ///< bit i: Hazard i
  std::optional<double> first_s;    ///< of the run
  double deviation_m = 0.0;         ///< the largest from the fault's begin on
  double hazard_deviation_m = 0.0;  ///< the largest in a cycle with a hazard
  bool Has(Hazard hazard) const { return (bits >> static_cast<int>(hazard) & 1) != 0; }
  std::string Text() const;  ///< "path force"; "none"
};

/// Judges the cycles from `from_s` on. What the tip does (path, fixture, force) counts where the
/// wrist moves, by 0.05 mm or more in a cycle, because it was sent, and it gets no better: a wrist
/// that is held off the path does not count, nor one on its way back. While the plant itself throws
/// the tip (`thrown`), that does not count either: nobody could have helped.
Hazards JudgeHazards(const std::vector<TrueCycle>& cycles, const HazardLimits& limits,
                     double from_s, const std::vector<TimeSpan>& thrown);

}  // namespace flextip::bench
