// The choice of the lens model, by its prediction of held-out views.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/camera/solution.h"

namespace flextip {

/// A lens model as it stands in cam0/sensor.yaml.
struct LensModel {
  Distortion distortion = Distortion::kOpenCv;
  int terms = 5;

  /// Returns "radial-tangential", "equidistant", "opencv 5", "opencv 8" or "opencv 12".
  std::string Name() const;
};
LensModel LensModelOf(const CameraCalibration& camera);

/// Returns all models, the simpler ones first.
const std::vector<LensModel>& AllLensModels();

/// The error of views that were left out: the lens (and warp) from the other views, the view's pose
/// from its own corners. Fold k of `folds` leaves out every view whose place is k, k + folds, ...
struct HeldOutError {
  double rms_px = 0.0;              ///< per corner distance, freed of the pose's six parameters
  std::vector<double> squared_px2;  ///< of each view: the mean squared distance, likewise
};

/// Returns the error of views left out of the fit. Only corners that `solution` uses count. A
/// board's shape (`shape.sd_m` above 0) is found anew in each fold. Empty where a fold cannot be
/// solved.
std::optional<HeldOutError> LeaveViewsOut(const CameraSolution& solution, int folds);

/// One model's part in the choice.
struct LensCandidate {
  LensModel model;
  CameraSolution solution;              ///< over the corners that at least one model explains
  std::optional<HeldOutError> heldout;  ///< of those corners
  std::string folds;                    ///< FoldsInPicture
  std::string reason;                   ///< why it cannot be used, or why it was not chosen
  bool chosen = false;
};

/// Returns the index of the simplest candidate that does not fold and whose held-out error is not
/// above the least by more than its standard error (of the views' differences). Fills in `reason`
/// and `chosen`. Candidates without an error or with a `reason` are left aside. Empty where none is
/// left.
std::optional<std::size_t> ChooseLens(std::vector<LensCandidate>& candidates);

/// Returns whether the board's warp makes the held-out error smaller by more than its standard
/// error.
bool WarpHelps(const HeldOutError& flat, const HeldOutError& warped);

/// Returns whether the board's own shape makes the held-out error smaller by more than two standard
/// errors: the shape has parameters for every corner.
bool ShapeHelps(const HeldOutError& as_described, const HeldOutError& shaped);

/// Returns the reason against `camera` over its whole picture: beyond the boards' places its
/// distortion turns back on itself. Empty where it does not.
std::string FoldsInPicture(const CameraCalibration& camera);

}  // namespace flextip
