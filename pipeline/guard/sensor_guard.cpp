#include "pipeline/guard/sensor_guard.h"

#include "pipeline/tip_fusion.h"

namespace flextip {
namespace {

std::uint8_t Bit(VotedSensor sensor) {
  return static_cast<std::uint8_t>(1U << static_cast<int>(sensor));
}

void Hold(Stop stop, Supervision& found) {
  if (found.reaction >= Reaction::kHold) return;
  found.stop = stop;
  found.reaction = Reaction::kHold;
}

}  // namespace

SensorGuard::SensorGuard(const EstimatorOptions& estimator, const SupervisorOptions& options)
    : options_(options),
      screen_(estimator.instrument, estimator.p_RP, options),
      vote_(estimator, options) {}

void SensorGuard::ScreenSensors(TimeNs t_ns, const std::optional<Eigen::Vector3d>& p_RW_sent,
                                SensorReadings& readings, Supervision& found) {
  if (options_.kind == SupervisionKind::kFull) screen_.Screen(t_ns, p_RW_sent, readings, found);
}

void SensorGuard::ScreenTip(TimeNs t_ns, const LateSamples& late, SensorReadings& readings,
                            Supervision& found) {
  jumped_ = 0;
  if (options_.kind == SupervisionKind::kFixedThresholds) {
    const bool jumps = screen_.TipIsFarther(options_.fixed_jump_m, readings);
    screen_.BelieveTip(readings, late);
    if (jumps) {
      readings.tip.reset();
      found.voted_out |= Bit(VotedSensor::kTip);
      Hold(Stop::kTipJump, found);
    }
    return;
  }
  if (options_.kind != SupervisionKind::kFull) return;
  std::optional<Eigen::Vector3d> p_RW;
  if (readings.wrist) p_RW = readings.wrist->value.p_RW;
  screen_.ScreenTip(t_ns, readings.tip, p_RW, found);
  if (screen_.TipJumps(readings, late)) jumped_ |= Bit(VotedSensor::kTip);
  if (screen_.EmJumps(readings, late)) jumped_ |= Bit(VotedSensor::kEm);
}

std::optional<VotedShaft> SensorGuard::Vote(TimeNs t_ns, const ShaftChange& change, Measurements& z,
                                            Supervision& found) {
  if (options_.kind == SupervisionKind::kFixedThresholds) {
    if (!z.tip || z.tip->status == TipStatus::kLost || !z.em) return {};
    const auto by_em = MeasuredTip({.em = z.em}, true);
    if ((z.tip->p_RE - *by_em).norm() > options_.fixed_jump_m) Hold(Stop::kTipDisagrees, found);
    return {};
  }
  if (options_.kind != SupervisionKind::kFull) return {};
  const std::uint8_t tip = Bit(VotedSensor::kTip);
  const bool alone = (SensorsOf(z) & ~tip) == 0;
  if (alone && (jumped_ & tip) != 0) {
    // Nobody else can say whether the tip was let go, or is seen wrong.
    Drop(VotedSensor::kTip, z);
    found.voted_out |= tip;
    Hold(Stop::kTipJump, found);
    return {};
  }
  const std::uint8_t voters = SensorsOf(z);
  if (screen_.HasNews() || voters != voters_) {
    voted_ = {};
    voters_ = voters;
    Measurements rest = z;
    shaft_ = vote_.Vote(t_ns, jumped_, change, rest, voted_);
  }
  for (int i = 0; i < kVotedSensors; ++i) {
    const auto sensor = static_cast<VotedSensor>(i);
    if (IsOut(voted_, sensor)) Drop(sensor, z);
  }
  found.voted_out |= voted_.voted_out;
  found.chi2 = voted_.chi2;
  found.chi2_limit = voted_.chi2_limit;
  if (voted_.doubt != Stop::kNone) found.doubt = voted_.doubt;
  if (voted_.reaction >= Reaction::kHold) Hold(voted_.stop, found);
  return shaft_;
}

void SensorGuard::Believe(const LateSamples& late, const SensorReadings& readings,
                          const Supervision& found) {
  if (options_.kind != SupervisionKind::kFull || found.reaction >= Reaction::kHold) return;
  if (!IsOut(found, VotedSensor::kTip)) screen_.BelieveTip(readings, late);
  if (!IsOut(found, VotedSensor::kEm)) screen_.BelieveEm(readings, late);
}

}  // namespace flextip
