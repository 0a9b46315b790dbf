// The figures of one way of seeing on many pictures beside their truth.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/vision/peer.h"
#include "vision/camera_model.h"

namespace flextip::bench {

/// What is known of a picture. Without a pose only corners are compared.
struct PictureTruth {
  TagsFound corners_px;  ///< corners of the tags that can be seen
  std::optional<Pose> T_CE;
};

/// How far a tag may be from its place and still be that tag.
constexpr double kSameTag_px = 3.0;
/// Beyond either a pose is false: it counts as such and not in the RMS.
constexpr double kFalsePose_m = 0.005, kFalsePose_deg = 10.0;

struct PeerFigures {
  std::string name;
  int pictures = 0, tags = 0, tags_found = 0, false_tags = 0, poses = 0, false_poses = 0;
  double corner_rms_px = 0;       ///< root of the mean squared distance of the corners found
  double pose_corner_rms_px = 0;  ///< the same of the corners that the pose says
  double tip_rms_mm = 0, tip_median_mm = 0, tip_largest_mm = 0;
  double depth_bias_mm = 0;  ///< mean error along the optical axis; positive: too far
  double turn_rms_deg = 0;
  double ms = 0;  ///< the median

  double Recall() const { return tags > 0 ? double(tags_found) / tags : 0; }
  int GoodPoses() const { return poses - false_poses; }
};

/// Gathers what a peer says.
class PeerScore {
 public:
  PeerScore(const CameraCalibration& camera, const TagCollar& collar)
      : camera_(camera), collar_(collar) {}
  /// Corners are compared in any of their four orders where `any_order`.
  void Add(const PeerAnswer& answer, const PictureTruth& truth, bool any_order = false);
  PeerFigures Figures(const std::string& name) const;

 private:
  void AddPose(const Pose& T_CE, const PictureTruth& truth);
  CameraModel camera_;
  TagCollar collar_;
  PeerFigures figures_;
  double corner_sum_px2_ = 0, pose_corner_sum_px2_ = 0, tip_sum_mm2_ = 0, depth_sum_mm_ = 0,
         turn_sum_deg2_ = 0;
  int corners_ = 0, pose_corners_ = 0;
  std::vector<double> tip_mm_, ms_;
};

}  // namespace flextip::bench
