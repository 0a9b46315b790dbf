// Late samples carried on to now: the tip and the EM sensor as they must be by what the wrist, and
// the other sensors, did since they were taken.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "estimation/shaft_estimator.h"
#include "estimation/shaft_rod.h"
#include "pipeline/readings_history.h"
#include "pipeline/sensor_readings.h"

namespace flextip {

struct LateSampleOptions {
  /// Deviation of the times of the tip's and of em0's samples. It enters the covariance by the
  /// speed that they had.
  double tip_time_sd_s = 0.0, em0_time_sd_s = 0.0;
  bool carry_em0 = false;  ///< em0 is late, too; if not it counts as simultaneous with the wrist
  double late_s = 0.0005;  ///< a tip older than the wrist by more is late
  /// A seen tip is carried on for so long after its first cycle, where no newer one comes.
  double keep_s = 0.12;
  double way_error = 0.05;  ///< sd of the carried way by the model's error, over the way
  /// Least sd of the load's wandering in a second, in EI / L^2. The wandering that the estimates
  /// show is taken where it is larger.
  double force_drift_units = 0.03;
};

/// Carries samples by the rod with the port, load and tissue that were estimated at the tip's time,
/// joined by how far the other sensors saw the tip go. Fixed size, allocates nothing.
class LateSamples {
 public:
  /// Takes how far tissue is trusted, as ControllerOptions.
  LateSamples(const LateSampleOptions& options, double max_tissue_gain)
      : options_(options), max_tissue_gain_(max_tissue_gain) {}

  /// Takes other deviations of the times of the tip's and of em0's samples.
  void SetTimeDeviations(double tip_sd_s, double em0_sd_s) {
    options_.tip_time_sd_s = tip_sd_s;
    options_.em0_time_sd_s = em0_sd_s;
  }

  /// Takes a cycle's readings into the past. Call it once a cycle, first.
  void Note(const SensorReadings& readings);

  /// Returns whether `readings` have a new tip that is late.
  bool HasLateTip(const SensorReadings& readings) const;

  /// Returns the readings as they were at `t_ns`, with the tip of `readings`; `readings` themselves
  /// from their wrist's time on. Empty before the past that is kept.
  std::optional<SensorReadings> PastAt(TimeNs t_ns, const SensorReadings& readings) const;

  /// Takes where the sensors without the tip see it at the wrist's time `t_ns`, with its covariance
  /// in R. Call it in every cycle in which they do.
  void NoteTipBySensors(TimeNs t_ns, const Eigen::Vector3d& p_RE,
                        const Eigen::Matrix3d& covariance_m2);

  /// Learns from the load that was estimated at `t_ns` how much it wanders.
  void Learn(TimeNs t_ns, const ShaftModel& model);

  /// Moves the samples of tip and em0 in `readings`, which stand in R, to the time of the wrist. A
  /// tip that is not there is the last one that was seen, carried on for `keep_s`. A tip of the
  /// wrist's own time stays as it is. Dropped are samples older than the past that is kept, and
  /// all late ones where the rod of `model`, as estimated last, has no equilibrium.
  /// Returns whether the tip now is one that was carried on.
  bool Carry(const ShaftModel& model, SensorReadings& readings);

  /// Returns the wrist's time in the cycle in which the tip that is carried on came.
  TimeNs TipCame_ns() const { return tip_first_ns_; }

  void VisitState(StateText& state);

 private:
  /// The motion of one place of the shaft since a time.
  struct Motion {
    Eigen::Vector3d way_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< of the way between two times
    /// Of the way because the time, or the wrist at that time, is not known: the same error whoever
    /// saw the way.
    Eigen::Matrix3d by_time_m2 = Eigen::Matrix3d::Zero();
    double turn_sd_rad = 0.0;  ///< of the turn, about each axis
  };
  struct Rods {
    ShaftRod then, now;
    void VisitState(StateText& state) {
      state(then);
      state(now);
    }
  };
  struct TipBySensors {
    TimeNs t_ns = 0;
    Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
    void VisitState(StateText& state) {
      state(t_ns);
      state(p_RE);
      state(covariance_m2);
    }
  };

  std::optional<Motion> MotionByRod(TimeNs t_ns, double time_sd_s,
                                    const Sample<WristMeasurement>& wrist, const ShaftModel& model,
                                    double distance_from_tip_m, Rods& rods) const;
  void JoinSensors(TimeNs from_ns, TimeNs to_ns, Motion& motion) const;
  std::optional<TipBySensors> TipBySensorsAt(TimeNs t_ns) const;
  bool CarryTip(const ShaftModel& model, SensorReadings& readings);
  void CarryEm0(const ShaftModel& model, SensorReadings& readings);

  LateSampleOptions options_;
  double max_tissue_gain_;
  ReadingsHistory history_;
  std::array<TipBySensors, 1024> by_sensors_;  // a ring, the newest before `next_`
  std::size_t next_ = 0, by_sensors_count_ = 0;
  std::optional<Sample<TipMeasurement>> tip_;  // seen last
  TimeNs tip_first_ns_ = 0;                    // the wrist's time at its first cycle
  Rods tip_rods_, em0_rods_;
  std::optional<Sample<Eigen::Vector3d>> load_;  // what the wandering is learnt against (N)
  double drift_variance_N2_s_ = 0.0;             // of a component, gained in a second
};

}  // namespace flextip
