// Samples looked at by themselves and against their own past, before anything is made of them.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>

#include "control/supervision/stops.h"
#include "control/supervision/supervisor_options.h"
#include "core/instrument.h"
#include "pipeline/late_samples.h"
#include "pipeline/sensor_readings.h"

namespace flextip {

/// Takes out samples that cannot be used, and finds places that jump. Fixed size, allocates
/// nothing.
class SampleScreen {
 public:
  /// `p_RP`: the port as registered (R, m).
  SampleScreen(const Instrument& instrument, const Eigen::Vector3d& p_RP,
               const SupervisorOptions& options)
      : length_m_(instrument.length_m), p_RP_(p_RP), options_(options) {}

  /// Takes out of `readings`, all but the tip, samples that are no numbers, older than one before,
  /// from the future, not renewed for too long, or that repeat the same figures while the wrist
  /// moves; a first repetition is a doubt. `p_RW_sent`: the last command. Call it once a cycle,
  /// first.
  void Screen(TimeNs t_ns, const std::optional<Eigen::Vector3d>& p_RW_sent,
              SensorReadings& readings, Supervision& found);

  /// The same for a tip that is new in this cycle.
  void ScreenTip(TimeNs t_ns, std::optional<Sample<TipMeasurement>>& tip,
                 const std::optional<Eigen::Vector3d>& p_RW, Supervision& found);

  /// Returns whether the tip or em0 lies where its last believed place and the wrist's motion since
  /// cannot have put it. Between the shaft's free motion about the port and none, all is possible:
  /// tissue holds the tip. `late` knows the wrist at the time of a late sample.
  bool TipJumps(const SensorReadings& readings, const LateSamples& late);
  bool EmJumps(const SensorReadings& readings, const LateSamples& late);
  /// Returns whether the tip is farther from its last believed place than `distance_m`.
  bool TipIsFarther(double distance_m, const SensorReadings& readings) const;

  /// Returns whether any sample is new since the last call of Screen.
  bool HasNews() const { return has_news_; }

  /// Returns whether there is no tip, or no new one for too long.
  bool TipIsStale(TimeNs t_ns) const { return IsStale(tip_past_, t_ns); }
  /// Returns whether the next tip should have come by now.
  bool TipIsOverdue(TimeNs t_ns) const;
  /// Returns whether, after one that came at `last_ns`, another one was to come by now, with half a
  /// cycle to spare.
  bool TipIsDue(TimeNs last_ns, TimeNs t_ns) const;

  /// Takes the places of `readings` as believed from now on.
  void BelieveTip(const SensorReadings& readings, const LateSamples& late);
  void BelieveEm(const SensorReadings& readings, const LateSamples& late);

  /// Takes what is measured next as believed: a person says that it is right.
  void Forget();

  void VisitState(StateText& state) {
    for (Past* past : {&wrist_, &tip_past_, &em0_past_, &em1_past_, &strain_past_, &load_past_})
      state(*past);
    state(tip_);
    state(em_);
    state(has_news_);
  }

 private:
  using Figures = Eigen::Matrix<double, 6, 1>;
  /// The samples of a stream.
  struct Past {
    TimeNs t_ns = 0, arrived_ns = 0;          // of the newest; of the cycle that had it first
    TimeNs gap_ns = 0;                        // between two, typically
    int repeats = 0;                          // of the same figures at new times
    int ages = 0;                             // samples whose age is known
    double age_s = 0.0, age_changes_s = 0.0;  // on arrival: typically, and how much it varies
    Figures figures = Figures::Zero();
    Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();  // the wrist at the first of them
    void VisitState(StateText& state) {
      for (TimeNs* time : {&t_ns, &arrived_ns, &gap_ns}) state(*time);
      state(repeats);
      state(ages);
      state(age_s);
      state(age_changes_s);
      state(figures);
      state(p_RW);
    }
  };
  struct Place {
    bool known = false;
    Eigen::Vector3d p = Eigen::Vector3d::Zero(), p_RW = Eigen::Vector3d::Zero();
    TimeNs t_ns = 0;
    double sd_m = 0.0;
    void VisitState(StateText& state) {
      state(known);
      state(p);
      state(p_RW);
      state(t_ns);
      state(sd_m);
    }
  };

  Stop Look(Past& past, TimeNs now_ns, TimeNs t_ns, const Figures& figures, bool finite,
            const std::optional<Eigen::Vector3d>& p_RW, double p_RW_sd_m);
  bool IsStale(const Past& past, TimeNs now_ns) const;
  bool IsOfAnotherAge(Past& past, double age_s) const;
  bool Jumps(const Place& last, const Place& now, double distance_from_tip_m,
             double p_RW_sd_m) const;
  Eigen::Vector3d Straight(const Eigen::Vector3d& p_RW, double distance_from_tip_m) const;

  double length_m_;
  Eigen::Vector3d p_RP_;
  SupervisorOptions options_;
  Past wrist_, tip_past_, em0_past_, em1_past_, strain_past_, load_past_;
  Place tip_, em_;
  bool has_news_ = false;  // in this cycle
  bool repeats_ = false;   // a stream that was looked at since it was set false
};

}  // namespace flextip
