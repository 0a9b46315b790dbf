// The pose of the tip frame E from the grey values of all visible tags at once, in one or more
// cameras.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "vision/photometric/view.h"

namespace flextip {

enum class PhotometricStatus {
  kOk,
  kNoFaces,       ///< no tag is where it should be
  kNotConverged,  ///< the steps do not become small
  kPoorFit,       ///< the picture does not look like the tags
};

struct PhotometricOptions {
  int coarse_pixels = 500;  ///< of all faces together, until the steps become small
  int max_pixels = 5000;    ///< of all faces together, near their edges, in the last steps
  double coarse_extra_blur_px2 = 2.0;  ///< widens the reach of the first steps
  int max_coarse_iterations = 8, max_iterations = 6;
  double min_correlation = 0.96;  ///< of a face's measured and predicted grey values
  double min_contrast_grey = 10.0;
  double max_contradicted = 0.02;  ///< of a face's pixels, white for black and black for white each
  double min_inliers = 0.6;        ///< mean weight of all pixels
  double model_noise_px = 0.015;   ///< what a tag's corners are wrong by whatever the noise: print,
                                   ///< lens, film; per axis
};

/// The result of one camera's picture.
struct ViewFit {
  OpticsPrior learned;  ///< its mean is the fitted value
  double noise_grey = 0;
  std::vector<FaceFit> faces;
};

struct PhotometricResult {
  PhotometricStatus status = PhotometricStatus::kNoFaces;
  Pose T_RE;
  /// Covariance of (dw, dp), where the true pose is (exp([dw]x) R, p + dp) of T_RE; both in R (rad,
  /// m).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int pixels = 0, faces = 0;
  int faces_in_view = 0;   ///< that should be seen well; more than `faces` where some are covered
  bool one_plane = false;  ///< all faces seen are parallel: two poses may look alike
  std::vector<ViewFit> views;

  bool IsUsable() const { return status == PhotometricStatus::kOk; }
};

/// Returns twice the log likelihood ratio of the pixels under `a` and under `b`, by the noise that
/// each fit leaves. Positive: `a` is likelier.
double LogLikelihoodRatio2(const PhotometricResult& a, const PhotometricResult& b);

class PhotometricFit {
 public:
  /// Reads the tags' cells and maps the lenses. Throws InputError for a tag that does not exist or
  /// a lens model that cannot be used.
  PhotometricFit(const std::vector<CameraCalibration>& cameras, const TagCollar& collar,
                 const PhotometricOptions& options = {});
  ~PhotometricFit();
  PhotometricFit(PhotometricFit&&) noexcept;
  PhotometricFit& operator=(PhotometricFit&&) noexcept;

  /// Fits the pose by Gauss-Newton from `start_T_RE`, which must be right to about a cell of the
  /// tag. Takes one image (null: no picture) and one prior a camera. `coarse`: begins with a
  /// widened blur. `rival`: a fit of the same images; one that a few pixels show to be clearly
  /// worse is not gone on with (kPoorFit). Failures are a status in the result.
  PhotometricResult Fit(const std::vector<const Image*>& images, const Pose& start_T_RE,
                        const std::vector<OpticsPrior>& priors, bool coarse = true,
                        const PhotometricResult* rival = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
