// All sensors of an instant held against the instrument and each other; the wrong one is found.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>

#include "control/supervision/chi_squared.h"
#include "control/supervision/path_watch.h"
#include "control/supervision/stops.h"
#include "control/supervision/supervisor_options.h"
#include "core/time_series.h"
#include "estimation/shaft_estimator.h"
#include "pipeline/guard/sensor_tolerances.h"

namespace flextip {

/// What the sensors that agree say together, with the tolerances in its covariances.
struct VotedShaft {
  PlaceKnown tip;
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
  Eigen::Matrix3d force_covariance_N2 = Eigen::Matrix3d::Zero();

  void VisitState(StateText& state) {
    state(tip);
    state(f_tip_N);
    state(force_covariance_N2);
  }
};

/// Chi-squared of all sensors together, with all covariances, and, where it is above its limit, of
/// all but one. Allocates nothing. One fit a call where the sensors agree, and where one of them
/// stays out by far: chi-squared of all is then that of the others' linear model. Sixteen at most.
/// After two calls in a row that named no sensor the next ones, for half of `resume_after_s`,
/// ask nobody and find the same: such a vote takes longer than a cycle.
class SensorVote {
 public:
  SensorVote(const EstimatorOptions& estimator, const SupervisorOptions& options);

  /// Takes out of `z` the one sensor without which the others agree, and those that were out less
  /// than `resume_after_s` ago. Where several sensors alone would explain it, the one that was out
  /// before is taken, then the one that jumped (`jumped`: bits as Supervision::voted_out), then the
  /// one that explains it far better. `found` gets the bits, chi-squared and, where no sensor can
  /// be named, a stop with a hold: where a wrist or a port elsewhere would explain all, that one's.
  /// A doubt where one sensor leaves the others by more than `SupervisorOptions::doubt`.
  /// Returns tip and load; empty where the sensors do not tell them.
  std::optional<VotedShaft> Vote(TimeNs t_ns, std::uint8_t jumped, const ShaftChange& change,
                                 Measurements& z, Supervision& found);

  void VisitState(StateText& state) {
    state(all_);
    state(without_one_);
    state(loose_);
    state(tolerated_);
    state(out_ns_);
    state(unnamed_);
  }

 private:
  /// The last vote; `stop`: what it holds by, where it named no sensor.
  struct Unnamed {
    TimeNs t_ns = 0;
    int in_a_row = 0;
    Stop stop = Stop::kNone;
    double chi2 = 0.0, chi2_limit = 0.0;
    void VisitState(StateText& state) {
      state(t_ns);
      state(in_a_row);
      state(stop);
      state(chi2);
      state(chi2_limit);
    }
  };
  /// The agreement of all sensors but one.
  struct Ballot {
    bool agrees = false, doubtful = false, from_all_starts = false;
    double chi2 = 0.0, limit = 0.0;
    std::optional<VotedShaft> shaft;
  };
  std::optional<VotedShaft> VoteAnew(TimeNs t_ns, std::uint8_t jumped, const ShaftChange& change,
                                     Measurements& z, Supervision& found, Stop& unnamed);
  Ballot Ask(ShaftEstimator& estimator, const Measurements& z, const ShaftChange& change) const;
  Ballot AskTwice(ShaftEstimator& estimator, const Measurements& z,
                  const ShaftChange& change) const;
  Ballot AskWithout(int sensor, Measurements z, const ShaftChange& change);
  std::optional<int> WhoStaysOut(TimeNs t_ns, const Measurements& z, const ShaftChange& change,
                                 Ballot& ballot);
  int LikeliestOut(TimeNs t_ns, std::uint8_t jumped, std::uint8_t candidates) const;
  std::uint8_t Lately(TimeNs t_ns) const;
  std::optional<VotedShaft> TakeOut(TimeNs t_ns, int sensor, const Ballot& ballot, Measurements& z,
                                    Supervision& found);
  bool WristExplains(const Measurements& z, const ShaftChange& change, double chi2_without);
  int Choose(TimeNs t_ns, std::uint8_t jumped, const std::array<Ballot, kVotedSensors>& without,
             std::uint8_t candidates) const;

  SupervisorOptions options_;
  ChiSquaredLimits limits_, doubts_;
  ToleratedSensors tolerated_;
  ShaftEstimator all_, without_one_, loose_;
  std::array<TimeNs, kVotedSensors> out_ns_{};  // when it was voted out last; 0: never
  Unnamed unnamed_;
};

/// Returns the sensors that `z` has, as bits.
std::uint8_t SensorsOf(const Measurements& z);
/// Takes a sensor out of `z`.
void Drop(VotedSensor sensor, Measurements& z);

}  // namespace flextip
