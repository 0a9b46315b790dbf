// The sensors' side of the supervisor: which samples and sensors may be used in a cycle.
#pragma once

#include <cstdint>
#include <optional>

#include "pipeline/guard/sample_screen.h"
#include "pipeline/guard/sensor_vote.h"

namespace flextip {

/// Screens samples, holds sensors against each other, and knows the last places that it believed.
/// With SupervisionKind::kFixedThresholds a tip is only held against its last place and em0, by a
/// distance. Fixed size, allocates nothing.
class SensorGuard {
 public:
  SensorGuard(const EstimatorOptions& estimator, const SupervisorOptions& options);

  /// Screens all samples but the tip, once a cycle, first.
  void ScreenSensors(TimeNs t_ns, const std::optional<Eigen::Vector3d>& p_RW_sent,
                     SensorReadings& readings, Supervision& found);

  /// Screens a tip that is new, and finds whether tip or em0 jump.
  void ScreenTip(TimeNs t_ns, const LateSamples& late, SensorReadings& readings,
                 Supervision& found);

  /// Votes on the sensors of the moment `t_ns`, and takes out of `z` what may not be used. Returns
  /// tip and load as those that are left say them; empty where they do not.
  std::optional<VotedShaft> Vote(TimeNs t_ns, const ShaftChange& change, Measurements& z,
                                 Supervision& found);

  /// Believes the places of `readings`, as ScreenTip left them, whose sensors are not out.
  void Believe(const LateSamples& late, const SensorReadings& readings, const Supervision& found);

  bool TipIsStale(TimeNs t_ns) const { return screen_.TipIsStale(t_ns); }
  bool TipIsOverdue(TimeNs t_ns) const { return screen_.TipIsOverdue(t_ns); }
  bool TipIsDue(TimeNs last_ns, TimeNs t_ns) const { return screen_.TipIsDue(last_ns, t_ns); }

  /// Takes the next places as they come: a person says that they are right.
  void Forget() { screen_.Forget(); }

  void VisitState(StateText& state) {
    state(screen_);
    state(vote_);
    state(jumped_);
    state(voted_);
    state(shaft_);
    state(voters_);
  }

 private:
  SupervisorOptions options_;
  SampleScreen screen_;
  SensorVote vote_;
  // The last vote: it stands until there is a new sample.
  Supervision voted_;
  std::optional<VotedShaft> shaft_;
  std::uint8_t voters_ = 0;  // the sensors it was of, as bits
  std::uint8_t jumped_ = 0;  // in this cycle, bits as Supervision::voted_out
};

}  // namespace flextip
