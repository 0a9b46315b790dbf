// Finds the step from the tube to its background on a short line across the tube's outline.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "core/image.h"
#include "vision/outline/tube_geometry.h"

namespace flextip {

/// An edge on one scan line.
struct ScanEdge {
  double offset_px = 0.0;  ///< from the line's middle, outward
  /// offset's variance = noise variance * `per_noise_px2`
  double per_noise_px2 = 0.0;
  double noise = 0.0;  ///< mean squared residual of the fit, per degree of freedom (linear light)
  double evidence = 0.0;  ///< log of residuals without over with an edge
};

/// Fits a blurred step in linear light. On the tube's side: a level and the darkening of its rim.
/// Behind: a level and a slope; behind a flat rim only 3 px are read, since the shadow there is
/// narrow. Neither sign nor brightness is assumed.
class ScanEdgeFinder {
 public:
  /// Takes the camera's gamma and the picture's Gaussian blur (px), without the pixel's own width.
  ScanEdgeFinder(double gamma, double blur_px);

  /// Samples the light (0 to 1) at `px + d outward` for d = -half .. half in whole pixels, each the
  /// mean over 2 `aside` + 1 neighbours along the edge. Returns false where a sample leaves the
  /// picture.
  bool Sample(const Image& grey, const Eigen::Vector2d& px, const Eigen::Vector2d& outward,
              int half_px, int aside, std::vector<float>& light) const;

  /// Gives the evidence for an edge at each whole pixel from -search to search. `light` has half_px
  /// = search + kMargin. `radius_px` is the tube's.
  void Evidence(const std::vector<float>& light, TubeRim rim, double radius_px,
                std::vector<float>& evidence) const;

  /// Returns the edge nearest to the pixel `at` (within 1.5 px), to a fraction of a pixel.
  std::optional<ScanEdge> Refine(const std::vector<float>& light, TubeRim rim, double radius_px,
                                 int at) const;

  static constexpr int kInside = 6, kOutside = 5;
  static constexpr int kMargin = kInside + 2;

 private:
  static constexpr int kSamples = kInside + kOutside + 1, kTerms = 4;
  static constexpr int kMiddle = 12, kPhases = 2 * kMiddle + 1;  // of an eighth of a pixel
  using Basis = Eigen::Matrix<float, kSamples, kTerms>;
  using Window = Eigen::Matrix<float, kSamples, 1>;

  /// A window of samples, rows `first` to `last` of kSamples, with what may be seen in it.
  struct Model {
    int first = 0, last = kSamples - 1;
    std::array<Basis, kPhases> step;  // orthonormal columns, an edge at each phase
    Basis smooth;                     // no edge
    Window Cut(const float* light) const;
  };
  Model MakeModel(TubeRim rim, int inside, int outside) const;
  const Model& ModelFor(TubeRim rim, double radius_px) const;

  double blur_px_;
  std::array<float, 256> light_;
  static constexpr int kLeastInside = 3;
  std::array<Model, kInside - kLeastInside + 1> round_;  // by how deep inside may be read
  Model flat_;
};

}  // namespace flextip
