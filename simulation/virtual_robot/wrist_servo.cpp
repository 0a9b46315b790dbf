#include "simulation/virtual_robot/wrist_servo.h"

#include <cmath>

#include "simulation/sensors/sensors.h"

namespace flextip::simulation {

WristServo::WristServo(const WristServoSetup& setup, const Eigen::Vector3d& p_RW_start,
                       std::uint64_t seed)
    : setup_(setup),
      rng_(seed),
      p_RW_(p_RW_start),
      p_RW_target_(p_RW_start),
      p_RW_newest_(p_RW_start),
      now_ns_(kSimulationStart_ns) {}

void WristServo::MoveTo(const Eigen::Vector3d& p_RW) {
  if (setup_.lost > 0.0 && std::uniform_real_distribution<double>()(rng_) < setup_.lost) return;
  p_RW_newest_ = p_RW;
  if (setup_.rate_hz == 0.0) p_RW_target_ = p_RW;
}

void WristServo::Stay() { p_RW_target_ = p_RW_newest_ = p_RW_; }

void WristServo::PutAt(const Eigen::Vector3d& p_RW) {
  p_RW_ = p_RW;
  Stay();
}

TimeNs WristServo::TickTime(std::int64_t tick) const {
  return kSimulationStart_ns + std::llround(static_cast<double>(tick) * 1e9 / setup_.rate_hz);
}

void WristServo::Advance(TimeNs t_ns) {
  if (setup_.rate_hz > 0.0) {
    for (TimeNs tick_ns = TickTime(ticks_); tick_ns <= t_ns; tick_ns = TickTime(ticks_)) {
      Approach(tick_ns);
      p_RW_target_ = p_RW_newest_;
      ++ticks_;
    }
  }
  Approach(t_ns);
}

void WristServo::Approach(TimeNs t_ns) {
  if (t_ns <= now_ns_) return;
  const double dt_s = 1e-9 * static_cast<double>(t_ns - now_ns_);
  Eigen::Vector3d step = p_RW_target_ - p_RW_;
  if (setup_.lag_s > 0.0) step *= -std::expm1(-dt_s / setup_.lag_s);
  const double reach = setup_.max_speed_m_s * dt_s;
  p_RW_ += step.norm() > reach ? Eigen::Vector3d(reach / step.norm() * step) : step;
  now_ns_ = t_ns;
}

}  // namespace flextip::simulation
