// The collar in one set of pictures: tags detected, or followed from where they are expected.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "core/state_text.h"
#include "vision/tags/background_detector.h"
#include "vision/tags/collar_search.h"
#include "vision/tracking/options.h"

namespace flextip {

/// A pose of E with all that belongs to it.
struct Sight {
  TrackSource source = TrackSource::kNone;
  Pose T_RE;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<TagDetection> tags;
  double rms_px = 0.0, noise_grey = 0.0, squared_error_px2 = 0.0;
  int tags_used = 0, dof = 0;
  bool ambiguous = false, outline_used = false;
  bool contradicts_collar = false;  ///< tags were seen where the collar cannot have them together
  std::optional<Pose> alternative_T_RE;
  PhotometricResult pixels;

  bool Found() const { return source != TrackSource::kNone; }
};

/// What corners alone may be wrong by: gamma, blur.
inline constexpr double kCornerFallback_px = 0.35;

/// One picture a camera; null: none.
using Images = std::vector<const Image*>;

class CollarLocaliser {
 public:
  CollarLocaliser(const std::vector<CameraCalibration>& cameras, const TagCollar& collar,
                  const TrackerOptions& options);

  /// By the pixels, from an expected pose; where that fails, after a search `radius_px` around it,
  /// and where that fails, by detection in that region.
  Sight FindNear(const Images& images, const Pose& T_RE, double radius_px);
  /// By detection in the whole pictures. `thorough`: as the options say, else at half resolution.
  Sight FindAnywhere(const Images& images, const std::optional<Pose>& near_T_RE, bool thorough);
  /// By the tags seen in one camera.
  Sight FromTags(std::size_t camera, const std::vector<TagDetection>& tags,
                 const std::optional<Pose>& near_T_RE, const CollarPoseOptions& options) const;

  /// Whether the tags might be seen in one of the cameras from T_RE.
  bool MightSee(const Pose& T_RE) const;
  /// What was learnt about the optics is kept for the next pictures.
  void Learn(const Sight& sight);
  /// What was learnt.
  void VisitState(StateText& state);
  /// Forgets the blur; what does not change is kept.
  void Forget();

 private:
  Sight FitPixels(const Images& images, const Pose& T_RE, bool coarse = true,
                  const PhotometricResult* rival = nullptr);
  bool IsComplete(const Sight& sight) const;
  bool IsTrusted(const Sight& sight, const Pose& expected_T_RE) const;
  /// Returns `sight`; with nothing found and `contradicts_collar` where its only tag is not where
  /// the collar has it beside the others that the pictures show.
  Sight HeldAgainstCollar(const Images& images, Sight sight);
  bool Contradicts(const Images& images, const Sight& sight);
  std::set<int> FacesOf(const Sight& sight) const;
  Sight Acquired(const Images& images, const Sight& corners, const std::optional<Pose>& near_T_RE);
  Sight Refined(const Images& images, const Sight& corners);
  Sight FitCandidates(const Images& images, const Sight& corners);
  bool MaySkipPlanarCheck(const Sight& sight, const Pose& expected_T_RE);
  void CheckOtherPlanarPose(const Images& images, const std::optional<Pose>& near_T_RE,
                            Sight& sight);
  std::vector<TagDetection> DetectNear(const Image& image, std::size_t camera, const Pose& T_RE,
                                       double radius_px);
  Sight BestOf(const std::vector<std::vector<TagDetection>>& tags,
               const std::optional<Pose>& near_T_RE) const;
  std::vector<TagDetection> PredictedTags(const PhotometricResult& fit) const;

  TagCollar collar_;
  TrackerOptions options_;
  std::vector<std::unique_ptr<CameraModel>> models_;
  std::vector<CollarSearch> searches_;
  TagDetector detector_;
  PhotometricFit fit_;
  std::vector<OpticsPrior> priors_;
  int planar_checks_spared_ = 0;  // frames left in which the other planar pose need not be tried
  double noise_grey_ = 0;         // of the fits so far, fading; 0: none
  /// What is known of a tag's place on the collar, a tag: of those that were fitted alone only.
  enum Standing { kUnknown, kAgrees, kContradicts };
  std::vector<int> standings_;
  int standing_checks_spared_ = 0;  // frames left in which a tag alone need not be looked at again
};

}  // namespace flextip
