// How an arm follows the set-points of its wrist: at a largest speed, behind them, at ticks of its
// own, and not all of them.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <random>

#include "core/time_series.h"

namespace flextip::simulation {

struct WristServoSetup {
  double max_speed_m_s = 0.2;
  double lag_s = 0.0;    ///< time constant of the approach (first order); 0: at the largest speed
  double rate_hz = 0.0;  ///< set-points are taken up at ticks of this rate; 0: at once
  double lost = 0.0;     ///< part of the set-points that never arrives, 0 to 1
};

/// A wrist in R, from kSimulationStart_ns on.
class WristServo {
 public:
  WristServo(const WristServoSetup& setup, const Eigen::Vector3d& p_RW_start, std::uint64_t seed);

  /// Takes a set-point now.
  void MoveTo(const Eigen::Vector3d& p_RW);
  /// Forgets the set-point: the wrist stays where it is.
  void Stay();
  /// Puts the wrist to a place where it stays.
  void PutAt(const Eigen::Vector3d& p_RW);
  /// Changes the largest speed; 0: the wrist stands.
  void SetMaxSpeed(double max_speed_m_s) { setup_.max_speed_m_s = max_speed_m_s; }
  /// Moves time on to `t_ns`.
  void Advance(TimeNs t_ns);

  const Eigen::Vector3d& p_RW() const { return p_RW_; }

 private:
  void Approach(TimeNs t_ns);
  TimeNs TickTime(std::int64_t tick) const;

  WristServoSetup setup_;
  std::mt19937_64 rng_;
  Eigen::Vector3d p_RW_, p_RW_target_, p_RW_newest_;  // reached, sought, last sent
  TimeNs now_ns_;
  std::int64_t ticks_ = 0;  // passed
};

}  // namespace flextip::simulation
