// The tip from place to place at one speed, and where the wrist of a straight shaft then is.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

/// Where a motion may go: the inserted length (m, port to tip) and the angle from the recorded
/// mean direction of the shaft.
struct Workspace {
  double inserted_from_m = 0.0, inserted_to_m = 0.0;
  double angle_rad = 0.0;
};
/// Returns the least that holds all of the recorded wrist's places.
Workspace RecordedWorkspace(const SampleSet& recorded);

/// Returns the highest speed (m/s) of the recorded wrist, but for one sample in twenty.
double RecordedSpeed(const SampleSet& recorded);

/// Returns where the tip of a straight shaft (`length_m`) from the wrist at `p_RW` through the port
/// `p_RP` is (m, in R).
Eigen::Vector3d StraightTip(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RP,
                            double length_m);

/// Straight lines of the tip, each from the end of the last, at a constant speed.
class TipCourse {
 public:
  /// Takes at least two places in R (m) and the port `p_RP`; the wrist, `length_m` from the tip
  /// through the port, is nowhere faster than `most_speed_m_s`.
  TipCourse(std::vector<Eigen::Vector3d> places, const Eigen::Vector3d& p_RP, double length_m,
            double most_speed_m_s);

  double Seconds() const { return ends_s_.back(); }
  double Speed() const { return speed_m_s_; }  ///< of the tip, m/s
  /// Returns the places (m, in R) up to then, the last of them where the tip is then.
  std::vector<Eigen::Vector3d> PlacesUntil(double t_s) const;
  Eigen::Vector3d Tip(double t_s) const;
  Eigen::Vector3d Wrist(double t_s) const;

 private:
  std::vector<Eigen::Vector3d> places_;
  Eigen::Vector3d p_RP_;
  double length_m_, speed_m_s_ = 1.0;
  std::vector<double> ends_s_;  // of each place: when the tip is there
};

}  // namespace flextip::diagnosis
