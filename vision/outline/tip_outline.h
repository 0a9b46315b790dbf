// The shaft's outline beside the tags: in one adjustment with them, or alone while they are
// covered.
#pragma once

#include <optional>
#include <vector>

#include "core/state_text.h"
#include "vision/outline/contour.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {

class TipOutline {
 public:
  /// Makes a contour a camera. Throws InputError as ShaftContour does.
  TipOutline(const std::vector<CameraCalibration>& cameras, const TubeShape& tube,
             const ContourOptions& options);

  /// Sets the blur of a camera's pictures (px), as the tags show it.
  void SetBlur(std::size_t camera, double blur_px);

  /// Visits the blurs.
  void VisitState(StateText& state);

  struct Joined {
    TipPrediction tip;
    bool end_seen = false;  ///< most of the shaft's end, in one of the pictures, where `tip` has it
  };
  /// Joins `seen` and the outlines in the pictures, each with its covariance, by a Gauss-Newton
  /// step on all of them from `seen`, and one more. Empty where no outline is seen that agrees with
  /// `seen`.
  std::optional<Joined> Join(const std::vector<const Image*>& images, const TipPrediction& seen);

  /// Finds the pose by the outlines in all cameras that show one. `expected` is the prior; roll and
  /// most of the depth come from there. Empty where the pose cannot be told, or is not where
  /// expected.
  std::optional<TipPrediction> Find(const std::vector<const Image*>& images,
                                    const TipPrediction& expected);

 private:
  struct View {
    CameraModel camera;
    double blur_px;
    ShaftContour contour;
    Image grey;  // right only around the outline
  };
  const Image& GreyAround(View& view, const Image& image, const Pose& T_CE) const;

  TubeShape tube_;
  ContourOptions options_;
  std::vector<View> views_;
};

}  // namespace flextip
