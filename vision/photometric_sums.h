// Sums over the pixels of a face: robust weights, normal equations, noise.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace flextip {

/// How residuals are weighted. Redescending: Tukey's biweight, nothing beyond `cut` times the
/// scale; else Huber's, ever less beyond the scale.
class RobustRule {
 public:
  RobustRule(double scale_grey, bool redescending)
      : scale_(static_cast<float>(scale_grey)),
        inverse_cut2_(1 / (kCut * kCut * scale_ * scale_)),
        redescending_(redescending) {}

  float Weight(float residual) const {
    if (redescending_) {
      const float t = 1 - residual * residual * inverse_cut2_;
      return t > 0 ? t * t : 0.0f;
    }
    const float size = std::abs(residual);
    return size < scale_ ? 1.0f : scale_ / size;
  }

 private:
  static constexpr float kCut = 4.7f;
  float scale_, inverse_cut2_;
  bool redescending_;
};

/// Parameters of a face's pixels: pose (dw, dc) about a pivot in C, blur, gamma, print offset, the
/// face's light; the last entry of a row is the residual.
struct FaceColumns {
  static constexpr int kBlur = 6, kGamma = 9, kOffset = 10, kLevels = 11, kResidual = 17;
  static constexpr int kSize = 18;
};

/// In grey values.
class FaceSums {
 public:
  using Row = Eigen::Matrix<float, FaceColumns::kSize, 1>;

  /// `row` is multiplied by the root of the weight already.
  void Add(const Row& row, float weight, float measured, float predicted) {
    rows_.col(filled_++) = row;
    if (filled_ == kBlock) Flush();
    moments_[0] += weight;
    moments_[1] += weight * predicted;
    moments_[2] += weight * measured;
    moments_[3] += weight * predicted * predicted;
    moments_[4] += weight * measured * measured;
    moments_[5] += weight * predicted * measured;
  }
  /// `half_contrast`: of the face (grey values).
  void CountError(float residual, float half_contrast) {
    brighter_ += residual > half_contrast;
    darker_ += residual < -half_contrast;
    const int bin = static_cast<int>(std::abs(residual) * kBinsPerGrey);
    ++errors_[std::min(bin, kBins - 1)];
    ++pixels_;
  }
  void Finish() { Flush(); }

  const Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize>& A() const { return A_; }
  int Pixels() const { return pixels_; }
  double Weight() const { return moments_[0]; }
  /// The part of the pixels that are white for black, or black for white if those are fewer. What
  /// covers a tag does one or the other; another tag does both.
  double Contradicted() const {
    return static_cast<double>(std::min(brighter_, darker_)) / std::max(1, pixels_);
  }
  /// Of measured and predicted grey values, weighted.
  double Correlation() const;

  /// Adds how many |residuals| fall into each bin of 1/8 grey level.
  static constexpr int kBinsPerGrey = 8, kBins = 256;
  using Histogram = std::array<int, kBins>;
  void AddErrorsTo(Histogram& histogram) const;

 private:
  static constexpr int kBlock = 64;  // rows are multiplied together, in single precision
  void Flush();

  Eigen::Matrix<float, FaceColumns::kSize, kBlock> rows_ =
      Eigen::Matrix<float, FaceColumns::kSize, kBlock>::Zero();
  int filled_ = 0, pixels_ = 0, brighter_ = 0, darker_ = 0;
  Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize> A_ =
      Eigen::Matrix<double, FaceColumns::kSize, FaceColumns::kSize>::Zero();
  std::array<float, 6> moments_{};
  Histogram errors_{};
};

}  // namespace flextip
