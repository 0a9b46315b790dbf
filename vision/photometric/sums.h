// Returns the sum over the pixels of (weight residual)^2; Curvature() that of the curvatures.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "vision/photometric/tag_blur.h"

namespace flextip {

/// The weight of a residual.
enum class Robustness {
  kHuber,        ///< ever less beyond the scale
  kTukey,        ///< the biweight: nothing beyond 4.7 times the scale
  kTukeyNewton,  ///< the same, and the normal matrix counts how the weights change with a step,
                 ///< which takes fewer steps near the minimum
};

class RobustRule {
 public:
  RobustRule(double scale_grey, Robustness kind)
      : scale_(static_cast<float>(scale_grey)),
        inverse_cut2_(1 / (kCut * kCut * scale_ * scale_)),
        kind_(kind) {}

  Robustness Kind() const { return kind_; }
  float Scale() const { return scale_; }
  float InverseCut2() const { return inverse_cut2_; }
  static constexpr float kLeastCurvature = 0.1f;

  float Weight(float residual) const {
    if (kind_ != Robustness::kHuber) {
      const float t = 1 - residual * residual * inverse_cut2_;
      return t > 0 ? t * t : 0.0f;
    }
    const float size = std::abs(residual);
    return size < scale_ ? 1.0f : scale_ / size;
  }

  /// Returns the factor of a pixel with that weight in the normal matrix; positive where the weight
  /// is.
  float Curvature(float weight) const {
    if (kind_ != Robustness::kTukeyNewton) return weight;
    const float t = std::sqrt(weight);
    return std::max(t * (5 * t - 4), kLeastCurvature * weight);
  }

 private:
  static constexpr float kCut = 4.7f;
  float scale_, inverse_cut2_;
  Robustness kind_;
};

/// Columns of a face's row: pose (dw, dc) about a pivot in C, blur, gamma, print offset, the face's
/// light. The last entry is the residual.
struct FaceColumns {
  static constexpr int kBlur = 6, kGamma = 9, kOffset = 10, kLevels = 11, kResidual = 17;
  static constexpr int kSize = 18;
};

/// Sums over a face's pixels, in grey values, as face_rows.h makes them.
class FaceSums {
 public:
  static constexpr int kPatchesAcross = 4, kPatches = kPatchesAcross * kPatchesAcross;
  /// Returns the patch at a place on the tag (-1 to 1 both ways).
  static int PatchOf(float fu, float fv) {
    const auto along = [](float f) {
      return std::clamp(static_cast<int>((f + 1) * (0.5f * kPatchesAcross)), 0, kPatchesAcross - 1);
    };
    return kPatchesAcross * along(fu) + along(fv);
  }

  /// Counts a pixel's residual (grey values).
  void CountError(float residual) {
    // A fit that goes astray may predict anything: the last bin takes it.
    const float last = kBins - 1;
    ++errors_[static_cast<int>(std::min(last, std::abs(residual) * kBinsPerGrey))];
    ++pixels_;
  }
  /// Counts pixels whose residuals are off by more than half the contrast (grey
  /// values).
  void CountContradictions(int brighter, int darker) { brighter_ += brighter, darker_ += darker; }

  /// The sums over the rows. A row has no entry for the print offset, which is the pose's
  /// move along the face's normal.
  struct Rows {
    static constexpr int kSize = 16, kGamma = 9, kLevels = 10;
    Eigen::Matrix<double, kSize, kSize> A = Eigen::Matrix<double, kSize, kSize>::Zero();
    Eigen::Matrix<double, kSize, kPatches> scores = Eigen::Matrix<double, kSize, kPatches>::Zero();
    /// Sums of weight, weight * predicted, * measured, * predicted^2, * measured^2, * both.
    std::array<double, 6> moments{};
    double squares = 0, curvature = 0;
  };
  /// Takes the sums after the last pixel. `normal_C` is the tag's; `spread` is the further part of
  /// the rows of pose and print offset (tag_blur.h).
  void Finish(const Rows& rows, const Eigen::Vector3d& normal_C, const SpreadByMotion& spread);

  const Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize>& A() const { return A_; }
  int Pixels() const { return pixels_; }
  double Weight() const { return moments_[0]; }
  /// Returns the share of the pixels that are white for black, or black for white if those are
  /// fewer. A body over the tag does one or the other; another tag does both.
  double Contradicted() const {
    return static_cast<double>(std::min(brighter_, darker_)) / std::max(1, pixels_);
  }
  /// Returns the weighted correlation of measured and predicted grey values.
  double Correlation() const;

  /// The gradient of each patch of the tag. Their scatter shows residuals that go together, which
  /// the number of pixels does not.
  using Scores = Eigen::Matrix<double, FaceColumns::kResidual, kPatches>;
  const Scores& PatchScores() const { return scores_; }
  /// Sums over the pixels of (weight residual)^2 and of the curvature.
  double WeightedSquares() const { return squares_; }
  double Curvature() const { return curvature_; }

  /// Adds the number of |residuals| in each bin of 1/8 grey level.
  static constexpr int kBinsPerGrey = 8, kBins = 256;
  using Histogram = std::array<int, kBins>;
  void AddErrorsTo(Histogram& histogram) const;

 private:
  int pixels_ = 0, brighter_ = 0, darker_ = 0;
  Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize> A_ =
      Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize>::Zero();
  std::array<double, 6> moments_{};
  Scores scores_ = Scores::Zero();
  double squares_ = 0, curvature_ = 0;
  Histogram errors_{};
};

}  // namespace flextip
