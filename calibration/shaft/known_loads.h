// A recording with known loads on the tip (hung masses, a load cell) as a list of holds: spans in
// which the stated load is constant and the wrist stands still. The mean over a hold loses the
// sensors' noise; the error of the stated load counts once.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.h"
#include "recording/recording.h"

namespace flextip {

/// Means over the hold, in R; noises are those of the means (standard deviations per axis).
struct LoadHold {
  TimeNs first_ns = 0, last_ns = 0;
  int samples = 0;
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
  double force_noise_N = 0.0;  ///< of the statement: not less for being repeated
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  double wrist_noise_m = 0.0;
  std::optional<Eigen::Matrix3d> R_RW;
  double wrist_turn_noise_rad = 0.0;

  std::optional<Eigen::Vector4d> readings;                    ///< of strain0, in its units
  Eigen::Vector4d reading_squares = Eigen::Vector4d::Zero();  ///< about the mean, summed
  std::optional<Eigen::Vector3d> p_RE;                        ///< vision0, seen in this instant
  Eigen::Matrix3d p_RE_covariance_m2 = Eigen::Matrix3d::Zero();
  std::optional<Eigen::Vector3d> d_RE;  ///< unit
  double direction_noise_rad = 0.0;
  std::optional<Pose> T_RS;  ///< em0
  double em_noise_m = 0.0, em_turn_noise_rad = 0.0;

  bool IsUnloaded() const { return f_tip_N.norm() <= 3 * force_noise_N || f_tip_N.isZero(0.0); }
};

enum class LoadClock { kStrain, kVision, kEm };

/// Returns the holds at the times of a sensor. Samples without load0 or wrist0 are left out. A hold
/// ends where another load is stated or the wrist has moved by 0.1 mm or six times its noise. A
/// load cell whose numbers differ from sample to sample gives holds of one sample. Above `most`
/// holds every n-th is taken.
std::vector<LoadHold> LoadHolds(const Recording& recording, LoadClock clock, std::size_t most);

/// Returns "at 12.3 s" or "12.3 to 14.5 s" after the first hold's start.
std::string SpanOf(const LoadHold& hold, TimeNs start_ns);

}  // namespace flextip
