// The inputs of a sample of the replayed model: the rod's inputs (kinematics/effect_rod.h) and the
// sensors'. Effects write into these, and every prediction is differentiated by them.
#pragma once

#include <Eigen/Dense>

#include "kinematics/effect_rod.h"

namespace flextip::diagnosis {

/// Indices of one sample's inputs. All are changes from the base simulation, so zero is the base;
/// the first rod_input::kCount are those of the rod in its order (kStiffness is the logarithm of
/// the stiffness over the nominal one). In R and SI units.
namespace sample_input {
using namespace rod_input;
inline constexpr int kTipCompliance = rod_input::kCount;  ///< E moves by this times the tip force
inline constexpr int kEmGradient = kTipCompliance + 1;    ///< 3x3, row by row, about the EM centre
inline constexpr int kEmOffset = kEmGradient + 9;         ///< of the EM position
inline constexpr int kEmDelay = kEmOffset + 3;            ///< s; samples are stamped late
inline constexpr int kCameraDelay = kEmDelay + 1;
inline constexpr int kCameraTurn = kCameraDelay + 1;  ///< of the camera about itself, rad
inline constexpr int kCameraShift = kCameraTurn + 3;  ///< of the camera
inline constexpr int kLogFocal = kCameraShift + 3;    ///< of the true focal length over calibrated
/// The turn of a pose by a changed focal length, over the tangent of the pose's angle off the axis.
inline constexpr int kFocalTurn = kLogFocal + 1;
/// The lens's k1 beyond its calibration; beside it what that does to the depth of a pose, and by
/// what it turns the pose, in proportion to r^2 as k1 does.
inline constexpr int kLensRadial = kFocalTurn + 1;
inline constexpr int kLensDepth = kLensRadial + 1;
inline constexpr int kLensTurn = kLensDepth + 1;
inline constexpr int kTagOffset = kLensTurn + 1;       ///< in E, of the tags against their mount
inline constexpr int kStrainGain = kTagOffset + 3;     ///< per gage, less one
inline constexpr int kStrainOffset = kStrainGain + 4;  ///< per gage, Nm
/// What a gage reads of another's moment: the off-diagonal entries, row by row.
inline constexpr int kStrainCross = kStrainOffset + 4;
inline constexpr int kEmTurn = kStrainCross + 12;  ///< EM frame in R about the centre, rad
inline constexpr int kEmShift = kEmTurn + 3;       ///< EM frame in R
inline constexpr int kVisionTurn = kEmShift + 3;   ///< vision's frame in R about the centre
inline constexpr int kVisionShift = kVisionTurn + 3;
/// Turns of a direction as it is read, alone (rad): of the EM sensor, the seen tip, the wrist.
inline constexpr int kEmReadTurn = kVisionShift + 3;
inline constexpr int kTipReadTurn = kEmReadTurn + 3;
inline constexpr int kWristReadTurn = kTipReadTurn + 3;
inline constexpr int kCount = kWristReadTurn + 3;
}  // namespace sample_input

/// The input by which gage `gage` reads the moment of another gage.
constexpr int StrainCross(int gage, int other) {
  return sample_input::kStrainCross + 3 * gage + other - (other > gage ? 1 : 0);
}

using SampleInputs = Eigen::Matrix<double, sample_input::kCount, 1>;

/// One sample's measured values, in rows of fixed places; directions count two (across the measured
/// one). A sample has those rows whose sensor spoke.
namespace row {
inline constexpr int kWristDirection = 0, kEmPosition = 2, kEmDirection = 5, kStrain = 7;
inline constexpr int kTipPosition = 11, kTipDirection = 14, kPortDirection = 16;
inline constexpr int kCount = 18;
}  // namespace row

using Rows = Eigen::Matrix<double, row::kCount, 1>;
using RowsByInputs = Eigen::Matrix<double, row::kCount, sample_input::kCount>;

/// The measured channels, for results: a run of rows with one name and unit.
struct Channel {
  const char* name;
  int first_row, rows;
};
inline constexpr Channel kChannels[] = {
    {"wrist0_orientation_rad", row::kWristDirection, 2},
    {"em0_position_m", row::kEmPosition, 3},
    {"em0_orientation_rad", row::kEmDirection, 2},
    {"strain0_moment_Nm", row::kStrain, 4},
    {"vision0_position_m", row::kTipPosition, 3},
    {"vision0_direction_rad", row::kTipDirection, 2},
    {"em1_orientation_rad", row::kPortDirection, 2},
};
inline constexpr int kChannelCount = 7;

}  // namespace flextip::diagnosis
