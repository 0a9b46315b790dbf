// What stands between controller and robot: one state machine over the findings of a cycle.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <optional>

#include "control/supervision/commanded_way.h"
#include "control/supervision/jerk_filter.h"
#include "control/supervision/stops.h"
#include "control/supervision/supervisor_options.h"
#include "core/state_text.h"
#include "core/time_series.h"

namespace flextip {

/// A cycle as the supervisor sees it. In R.
struct SupervisedCycle {
  TimeNs t_ns = 0;
  std::optional<Eigen::Vector3d> p_RW;    ///< as measured in this cycle
  double p_RW_noise_m = 0.0;              ///< standard deviation per axis
  std::optional<Eigen::Vector3d> p_wish;  ///< the controller's command; empty: none
  Supervision found;                      ///< the gravest finding so far; reaction as it asks for
  bool may_point_wrong = false;           ///< the Jacobian of the wish is not known well enough
  bool tip_is_hidden = false;             ///< the wish is for a tip that is not seen just now
  bool resume = false;                    ///< a person says go on
};

/// Decides over each command, and remembers. Allocates nothing.
class Supervisor {
 public:
  explicit Supervisor(const SupervisorOptions& options)
      : options_(options), jerk_(options.rates, options.rate_hz), way_(options.follow_lag_s) {}

  struct Decision {
    std::optional<Eigen::Vector3d> p_RW_command;  ///< empty before the wrist was ever measured
    Supervision supervision;
    bool resumed = false;  ///< a person's resume ended a fault in this cycle
  };

  /// Returns the command that may go out: the wish within the rate limits, or, in a hold and in a
  /// fault, the wrist as it was measured when the hold began; the last command where that reading
  /// is not on the commanded way.
  Decision Decide(const SupervisedCycle& cycle);

  /// Takes what really went out in this cycle, where somebody limited the command further.
  void NoteSent(const Eigen::Vector3d& p_RW);

  /// Returns the command sent last; empty before the first.
  const std::optional<Eigen::Vector3d>& LastCommand() const { return p_last_; }

  void VisitState(StateText& state);

 private:
  std::optional<Eigen::Vector3d> StopAt(const SupervisedCycle& cycle) const;
  void Keep(const SupervisedCycle& cycle, const Eigen::Vector3d& p_RW);
  Eigen::Vector3d Limit(const SupervisedCycle& cycle, Supervision& supervision);
  Stop Doubt(const SupervisedCycle& cycle);
  bool IsNoChance(Stop doubt, TimeNs t_ns) const;
  void Judge(const SupervisedCycle& cycle, Decision& decision);

  SupervisorOptions options_;
  JerkFilter jerk_;
  std::optional<Eigen::Vector3d> p_limited_;  // before the limit of jerk, while it moves
  CommandedWay way_;
  std::optional<Eigen::Vector3d> p_last_, p_held_;
  Eigen::Vector3d v_last_m_s_ = Eigen::Vector3d::Zero();
  TimeNs t_last_ns_ = 0;
  TimeNs wrong_since_ns_ = 0;                      // since when it may point wrong; 0: it does not
  TimeNs doubt_since_ns_ = 0;                      // since when there is doubt; 0: there is none
  TimeNs held_since_ns_ = 0, clear_since_ns_ = 0;  // 0: not held, not clear
  Stop held_by_ = Stop::kNone;
  int late_cycles_ = 0;  // in a row
  bool fault_ = false, moving_ = false;
};

}  // namespace flextip
