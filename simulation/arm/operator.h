// A person at the master's stylus who scrapes soft tissue by sight (thesis 5.2.6, 5.2.7): covers a
// circle, presses as deeply as the virtual wall lets, trembles, and puts right what the monitor
// shows, late.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <deque>
#include <random>
#include <vector>

namespace flextip::simulation {

/// What differs from person to person.
struct OperatorTraits {
  double speed_m_s = 0.015;          ///< average along the surface
  double tremor_m = 1.5e-4;          ///< RMS per axis
  double tremor_hz = 10.0;           ///< 8 to 12
  double pressing_m = 0.006;         ///< how far past the wall the stylus is pushed, average
  double pressing_change_m = 0.003;  ///< how much that wanders (standard deviation)
  double delay_s = 0.2;              ///< from monitor to hand
  double correction_1_s = 2.0;       ///< rate at which a seen offset is taken back
};

/// Traits drawn for one person: normal about the defaults, within what people do.
OperatorTraits DrawOperator(std::uint64_t seed);

/// Where the task is. Everything in R.
struct OperatorTask {
  Eigen::Vector3d p_centre = Eigen::Vector3d::Zero();  ///< of the outline, on the wall
  Eigen::Vector3d inward = Eigen::Vector3d::UnitX();   ///< unit, into the tissue
  double outline_radius_m = 0.02;
  double approach_m = 0.012;  ///< starts this far outside the wall
  /// Of the camera: two directions along the monitor, unit, in R.
  Eigen::Vector3d right = Eigen::Vector3d::UnitY(), up = Eigen::Vector3d::UnitZ();
};

class SimulatedOperator {
 public:
  SimulatedOperator(const OperatorTask& task, const OperatorTraits& traits, std::uint64_t seed);

  /// The stylus in R after another `dt_s`, the tip being seen at `p_tip` now. Call at a fixed rate.
  Eigen::Vector3d Step(double dt_s, const Eigen::Vector3d& p_tip);

  const OperatorTraits& Traits() const { return traits_; }

 private:
  void ChooseTarget();
  void MovePlan(double dt_s);
  void Correct(double dt_s, const Eigen::Vector3d& p_tip);
  Eigen::Vector3d Tremor(double dt_s);
  Eigen::Vector3d At(const Eigen::Vector2d& plan) const;

  struct Seen {
    double t_s;
    Eigen::Vector2d plan, offset;  // intended place, and where the tip was from there, as seen
  };

  OperatorTask task_;
  OperatorTraits traits_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  double t_s_ = 0.0;
  Eigen::Vector2d from_ = Eigen::Vector2d::Zero(), to_ = from_, plan_ = from_;
  double stroke_s_ = 0.0, stroke_done_s_ = 0.0;
  std::vector<Eigen::Vector2d> visited_;
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();
  std::deque<Seen> seen_;
  double pressing_ = 0.0;  // deviation from the average
  Eigen::Vector3d tremor_ = Eigen::Vector3d::Zero(), tremor_rate_ = Eigen::Vector3d::Zero();
};

}  // namespace flextip::simulation
