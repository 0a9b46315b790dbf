// Follows the instrument's tip in pictures: the tracker of tags, told by wrist and shaft model
// where to look, and the bending of the shaft beyond the collar.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinematics/tip_bending.h"
#include "pipeline/guard/still_pictures.h"
#include "pipeline/guard/tip_range.h"
#include "pipeline/sensor_readings.h"
#include "pipeline/tip_predictor.h"
#include "recording/recording.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {

struct InstrumentTrackerSetup {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();  ///< the port as registered
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  std::vector<CameraCalibration> cameras;  ///< one, or both eyes
  TagCollar collar;
  TrackerOptions tracker;
  bool with_model = true;       ///< expect the tip by wrist and shaft model
  bool camera_has_pose = true;  ///< else tips are in the camera's frame, and no wrist is in that
};

/// Returns the instrument and cameras of `recording`, which has cam0 and tags0. The model is used
/// where `with_model` and the wrist was recorded.
InstrumentTrackerSetup TrackerSetupOf(const Recording& recording,
                                      const TrackerOptions& options = {}, bool with_model = true);

class InstrumentTracker {
 public:
  /// Throws InputError for a camera or a collar that cannot be used.
  explicit InstrumentTracker(const InstrumentTrackerSetup& setup);

  /// Finds the tip in the pictures of one instant, one a camera (null: that camera has none).
  /// `readings` of that instant; their tip is not looked at. Where the load was measured, the shaft
  /// bends beyond the collar. With the model a tip that wrist and shaft cannot have there, and one
  /// of a picture that stood still while the wrist moved, are no measurement (TipTrack::doubt).
  /// Throws InputError where a picture's size is not the camera's.
  TipTrack Follow(std::span<const Image* const> pictures, TimeNs t_ns,
                  const SensorReadings& readings);

  /// Returns the state for going on in another run. The model's solvers start afresh at a call. So
  /// a run that is to give the same results must call State after the same frames.
  std::string State();
  /// Throws InputError where `state` is not of a tracker with the same options.
  void SetState(const std::string& state);

 private:
  void VisitState(StateText& state);
  /// From the rigid collar's tip to the true one; the identity where the load is not known.
  struct Bend {
    Pose T_EE;
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< in R
  };
  Bend BendUnder(const std::optional<Sample<LoadMeasurement>>& load, const Pose& T_RE) const;

  FreeEnd beyond_collar_;
  TipTracker tracker_;
  std::optional<TipPredictor> model_;
  std::optional<TipRange> range_;
  StillPictures still_;
};

}  // namespace flextip
