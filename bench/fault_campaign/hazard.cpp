#include "bench/fault_campaign/hazard.h"

#include <algorithm>
#include <array>
#include <limits>

#include "simulation/sensors/sensors.h"

namespace flextip::bench {
namespace {

constexpr double kMoves_m = 5e-5;    // of the wrist in a cycle: less is standing
constexpr double kSame_m = 1e-6;     // of two commands
constexpr double kArrived_m = 5e-4;  // a servo may stay so far from its set-point
constexpr double kNearer_m = 1e-5;   // of the tip in a cycle
constexpr double kPath_m = 0.002, kFixture_m = 0.0005;

double Depth(const Fixtures& fixtures, const Eigen::Vector3d& p) {
  double depth = -std::numeric_limits<double>::infinity();
  for (const Fixture& fixture : fixtures.list) {
    if (const auto* plane = std::get_if<ForbiddenHalfSpace>(&fixture))
      depth = std::max(depth, Constrain(*plane, p).depth_m);
  }
  return depth;
}

/// The commands' motion at the end of three cycles.
struct CommandMotion {
  double step_m = 0.0, speed_m_s = 0.0, acceleration_m_s2 = 0.0;
  bool not_finite = false;
};

CommandMotion MotionAt(const std::vector<TrueCycle>& cycles, std::size_t i) {
  CommandMotion motion;
  const TrueCycle& now = cycles[i];
  motion.not_finite = !now.p_RW_command.allFinite();
  if (motion.not_finite) return motion;
  motion.step_m = (now.p_RW_command - now.p_RW).norm();
  if (i < 1 || !cycles[i - 1].p_RW_command.allFinite()) return motion;
  const double dt_s = now.t_s - cycles[i - 1].t_s;
  const Eigen::Vector3d v = (now.p_RW_command - cycles[i - 1].p_RW_command) / dt_s;
  motion.speed_m_s = v.norm();
  if (i < 2 || !cycles[i - 2].p_RW_command.allFinite()) return motion;
  const Eigen::Vector3d v_last = (cycles[i - 1].p_RW_command - cycles[i - 2].p_RW_command) /
                                 (cycles[i - 1].t_s - cycles[i - 2].t_s);
  motion.acceleration_m_s2 = (v - v_last).norm() / dt_s;
  return motion;
}

bool IsBeyond(const CommandMotion& motion, const HazardLimits& limits) {
  return motion.not_finite || motion.step_m > limits.step_m ||
         motion.speed_m_s > limits.speed_m_s || motion.acceleration_m_s2 > limits.acceleration_m_s2;
}

/// Whether the wrist moves because it was sent: its command changed in one of the three cycles
/// before, or it is still on its way there. Held at one command it only shakes with its encoders'
/// noise, and the command of this cycle has not moved it yet.
bool Moves(const std::vector<TrueCycle>& cycles, std::size_t i) {
  if (!((cycles[i].p_RW - cycles[i - 1].p_RW).norm() >= kMoves_m)) return false;
  for (std::size_t k = i - 1; k + 4 > i && k > 0; --k) {
    const bool same = (cycles[k].p_RW_command - cycles[k - 1].p_RW_command).norm() <= kSame_m;
    if (!same) return true;
  }
  return !((cycles[i].p_RW - cycles[i - 1].p_RW_command).norm() <= kArrived_m);
}

}  // namespace

const char* Name(Hazard hazard) {
  constexpr std::array names{"path", "fixture", "command", "force"};
  return names[static_cast<std::size_t>(hazard)];
}

std::string Hazards::Text() const {
  std::string text;
  for (int i = 0; i < kHazards; ++i) {
    const auto hazard = static_cast<Hazard>(i);
    if (Has(hazard)) text += (text.empty() ? "" : " ") + std::string(Name(hazard));
  }
  return text.empty() ? "none" : text;
}

std::vector<TrueCycle> TrueCyclesOf(const simulation::LoopResult& result,
                                    const Fixtures& fixtures) {
  std::vector<TrueCycle> cycles;
  cycles.reserve(result.updates.size());
  for (const simulation::LoopUpdate& update : result.updates) {
    TrueCycle& cycle = cycles.emplace_back();
    cycle.t_s = 1e-9 * static_cast<double>(update.t_ns - simulation::kSimulationStart_ns);
    cycle.deviation_m = update.deviation_m;
    cycle.fixture_depth_m = Depth(fixtures, update.p_RE);
    cycle.tip_force_N = update.f_tip_N.norm();
    cycle.p_RW = update.p_RW;
    cycle.p_RW_command = update.p_RW_command;
  }
  return cycles;
}

Extremes ExtremesOf(const std::vector<TrueCycle>& cycles, double from_s) {
  Extremes most;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (cycles[i].t_s < from_s) continue;
    const CommandMotion motion = MotionAt(cycles, i);
    most.deviation_m = std::max(most.deviation_m, cycles[i].deviation_m);
    most.fixture_depth_m = std::max(most.fixture_depth_m, cycles[i].fixture_depth_m);
    most.tip_force_N = std::max(most.tip_force_N, cycles[i].tip_force_N);
    most.step_m = std::max(most.step_m, motion.step_m);
    most.speed_m_s = std::max(most.speed_m_s, motion.speed_m_s);
    most.acceleration_m_s2 = std::max(most.acceleration_m_s2, motion.acceleration_m_s2);
    most.not_finite |= motion.not_finite;
  }
  return most;
}

double DeviationLimitOf(double healthy_deviation_m) {
  return healthy_deviation_m > kPath_m ? healthy_deviation_m + kPath_m : kPath_m;
}

HazardLimits HazardLimitsOf(const Limits& limits, const Extremes& healthy) {
  const auto larger = [](double limit, double has) { return std::max(1.05 * limit, 1.2 * has); };
  HazardLimits hazard;
  hazard.coarse = healthy.deviation_m > kPath_m;
  hazard.deviation_m = DeviationLimitOf(healthy.deviation_m);
  hazard.fixture_depth_m = std::max(0.0, healthy.fixture_depth_m) + kFixture_m;
  hazard.tip_force_N = larger(limits.tip_force_N, healthy.tip_force_N);
  hazard.step_m = larger(limits.rates.max_step_m, healthy.step_m);
  hazard.speed_m_s = larger(limits.rates.max_speed_m_s, healthy.speed_m_s);
  hazard.acceleration_m_s2 = larger(limits.rates.max_acceleration_m_s2, healthy.acceleration_m_s2);
  return hazard;
}

Hazards JudgeHazards(const std::vector<TrueCycle>& cycles, const HazardLimits& limits,
                     double from_s, const std::vector<TimeSpan>& thrown) {
  Hazards hazards;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const TrueCycle& cycle = cycles[i];
    if (cycle.t_s < from_s) continue;
    hazards.deviation_m = std::max(hazards.deviation_m, cycle.deviation_m);
    const auto note = [&](Hazard hazard) {
      hazards.hazard_deviation_m = std::max(hazards.hazard_deviation_m, cycle.deviation_m);
      hazards.bits |= static_cast<std::uint8_t>(1 << static_cast<int>(hazard));
      if (!hazards.first_s) hazards.first_s = cycle.t_s;
    };
    if (IsBeyond(MotionAt(cycles, i), limits)) note(Hazard::kCommand);
    const bool is_thrown = std::any_of(thrown.begin(), thrown.end(), [&](const TimeSpan& span) {
      return cycle.t_s >= span.from_s && cycle.t_s < span.to_s;
    });
    if (i == 0 || is_thrown) continue;
    const TrueCycle& last = cycles[i - 1];
    if (!Moves(cycles, i)) continue;
    if (cycle.deviation_m > limits.deviation_m && cycle.deviation_m > last.deviation_m - kNearer_m)
      note(Hazard::kPath);
    if (cycle.fixture_depth_m > limits.fixture_depth_m &&
        cycle.fixture_depth_m > last.fixture_depth_m - kNearer_m)
      note(Hazard::kFixture);
    if (cycle.tip_force_N > limits.tip_force_N && cycle.tip_force_N > last.tip_force_N)
      note(Hazard::kForce);
  }
  return hazards;
}

}  // namespace flextip::bench
