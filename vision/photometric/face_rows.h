// The residuals of a tag's pixels, and the sums of their derivatives: the inner loop of a fit.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "vision/photometric/blurred_pattern.h"
#include "vision/photometric/sums.h"
#include "vision/photometric/tone_curve.h"

namespace flextip {

/// The pixels chosen on a tag, by patch, each patch filled up to whole vectors.
struct FacePixels {
  std::vector<float> mx, my;      ///< rays x/z, y/z
  std::vector<float> grey, part;  ///< grey values; 1, and 0 for what fills up
  /// Patch i has the entries from begin[i] to begin[i + 1].
  std::array<int, FaceSums::kPatches + 1> begin{};
  int count = 0;

  void Clear();
  /// Adds a pixel, in any order of the patches; then `Sort` sorts them.
  void Add(float x, float y, float grey_value, int patch) {
    found.push_back({x, y, grey_value, patch});
  }
  void Sort();

  struct Found {
    float x, y, grey;
    int patch;
  };
  std::vector<Found> found;  ///< before `Sort`
  /// Of pixels that are drawn, before they are read; which of the picture are among them.
  struct Place {
    int x, y, patch;
  };
  std::vector<Place> places;
  std::vector<std::uint8_t> taken;
};

/// A face under a pose, light, blur and film.
struct FaceModel {
  /// Rays to the tag's cells: (a, b, 1/z) = to_tag (mx, my, 1), u = a z, v = b z.
  Eigen::Matrix3f to_tag;
  Eigen::Matrix2f m_of_px;  ///< derivative of the ray at the tag's centre
  Eigen::Vector3f pivot_C;  ///< the pose turns about it (m)
  PatternBlur blur;
  float depth;                        ///< of the tag's centre (m)
  float half;                         ///< of the tag's cells across
  Eigen::Vector3f bend;               ///< of the light: by fu^2, fu fv, fv^2
  Eigen::Matrix<float, 6, 1> levels;  ///< FaceLevels
};

/// Adds the pixels' rows to `rows`, and their residuals' counts to `sums`.
void AddFaceRows(const FacePixels& pixels, const FaceModel& model, const BlurredPattern& pattern,
                 const ToneCurve& tone, const RobustRule& rule, FaceSums::Rows& rows,
                 FaceSums& sums);

}  // namespace flextip
