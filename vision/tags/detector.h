// The one adapter over the AprilTag library: its pixel origin, corner order and corner bias end
// here.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"

namespace flextip {

using TagCorners = std::array<Eigen::Vector2d, 4>;

/// A tag seen in an image. The corners are those of the edge that the library finds: the black
/// border's outer edge (tag36h11, 25h9, 16h5), or its inner edge where cells lie outside the border
/// too (tagStandard, tagCircle: white within, black without). Their order is (-,+), (+,+), (+,-),
/// (-,-) in the tag frame G (x right, y down as it is read): bottom left, bottom right, top right,
/// top left of the upright tag.
struct TagDetection {
  int id = 0;
  int hamming = 0;                      ///< corrected bits
  double decision_margin = 0.0;         ///< mean distance of a bit's grey value from the threshold
  TagCorners corners_px = NoCorners();  ///< pixel (0,0) is a pixel's centre
  TagCorners raw_corners_px = NoCorners();  ///< the library's, in its origin (centres at .5)
  bool refined = false;  ///< corners_px come from the edges fitted here, not the library

  static TagCorners NoCorners() {
    TagCorners corners;
    corners.fill(Eigen::Vector2d::Zero());
    return corners;
  }
};

struct TagDetectorOptions {
  /// tag36h11, tag36h10, tag25h9, tag16h5, tagCircle21h7, tagStandard41h12 or tagStandard52h13.
  std::string family = "tag36h11";
  double quad_decimate = 1.0;  ///< quads are searched at 1/this of the resolution; >= 1
  double quad_sigma_px = 0.0;  ///< Gaussian blur before the search
  bool refine_edges = false;   ///< the library's own refinement; with it a few are not read
  double decode_sharpening = 0.25;
  int threads = 1;
  int max_hamming = 2;  ///< more corrected bits are not accepted; 1 at most in tagStandard52h13
  double min_decision_margin = 10.0;  ///< and those with less contrast
  bool refine_corners = true;         ///< fit the four edges to the image again (edge_refiner.h)
};

/// Finds tags in pictures. One detector must not be used by two threads at once.
class TagDetector {
 public:
  /// Makes a detector. Throws InputError where an option is out of range or the family is unknown.
  explicit TagDetector(const TagDetectorOptions& options = {});
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// Returns the tags in a grey or colour image, sorted by id; an empty list is an ordinary result.
  /// Quads are searched at 1 / max(quad_decimate, `min_decimate`) of the resolution. Throws
  /// InputError for an empty image and for one with neither 1 nor 3 channels.
  std::vector<TagDetection> Detect(const Image& image, double min_decimate = 1.0);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the grey values of an image with 1 or 3 channels (blue, green, red; weights of Rec.
/// 601). Throws InputError for an empty image and for other numbers of channels.
Image ToGrey(const Image& image);

}  // namespace flextip
