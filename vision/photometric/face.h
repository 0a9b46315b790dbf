// One tag of the collar against the pixels it covers.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "vision/camera_model.h"
#include "vision/photometric/blurred_pattern.h"
#include "vision/photometric/face_rows.h"
#include "vision/photometric/lens_map.h"
#include "vision/photometric/sums.h"
#include "vision/photometric/tone_curve.h"

namespace flextip {

/// Properties of a whole picture: the lens's blur, the film's gamma and the prints' offset.
struct Optics {
  /// Covariance xx, xy, yy (px^2) of the blur, without a pixel's own extent: defocus and motion.
  Eigen::Vector3d blur_px2{0.6, 0.0, 0.6};
  double gamma = 2.2;
  /// Distance of all tags from their stated planes along their normals, outward (m): print and
  /// glue.
  double print_offset_m = 0.0;
};

/// A face's light: black and white, each level + slope times the place on the tag (-1..1).
using FaceLevels = Eigen::Matrix<double, 6, 1>;  // black, black_u, black_v, white, white_u, white_v

class PhotometricFace {
 public:
  /// The surroundings of the tag toward -x, +x, -y and +y of G.
  struct Side {
    double reach_m = 0;                  ///< how far from the centre the tag's surroundings go on
    std::optional<Pose> neighbour_T_EG;  ///< the tag that meets this one's plane there
  };
  PhotometricFace(const CollarTag& tag, const TagCells& cells, const std::array<Side, 4>& sides);

  const CollarTag& Tag() const { return tag_; }
  /// Returns a cell's side over the tag's size.
  double CellPart() const { return cell_m_ / tag_.size_m; }

  /// Returns whether the face looks to the camera at T_CE, at less than 84 degrees from its normal,
  /// and lies in the picture at least in part.
  bool IsSeen(const CameraModel& camera, const Pose& T_CE) const;
  /// Returns the cosine of the angle between the face's normal and the line of sight.
  double Cosine(const Pose& T_CE) const;

  /// Which of the pixels near the tag's edges take part.
  struct Choice {
    int stride = 1;      ///< every so many-th in both directions
    float reach = 2.9f;  ///< sigmas of the blur from an edge
    float share = 1.0f;  ///< of those, scattered evenly
  };
  /// Returns the number of pixels per sigma of reach, roughly, at T_CE.
  double PixelsPerSigma(const CameraModel& camera, const Pose& T_CE, const Optics& optics) const;
  /// Chooses pixels near the tag's edges, and a few others, at T_CE.
  void SelectPixels(const CameraModel& camera, const LensMap& lens, const Image& image,
                    const Pose& T_CE, const Optics& optics, const Choice& choice);
  int Pixels() const { return pixels_.count; }

  /// Sets the levels that the pixels show at T_CE, without slopes. Returns their correlation with
  /// the pattern; 0 where the tag has no contrast there.
  double GuessLevels(const CameraModel& camera, const Pose& T_CE, const Optics& optics,
                     const ToneCurve& tone);

  /// Adds the pixels' residuals (grey values) and derivatives at T_CE to `sums`. The pose turns
  /// about the point `pivot_C` (m).
  void Accumulate(const CameraModel& camera, const Pose& T_CE, const Eigen::Vector3d& pivot_C,
                  const Optics& optics, const ToneCurve& tone, const RobustRule& rule,
                  FaceSums& sums) const;

  FaceLevels levels = FaceLevels::Zero();  ///< in light

 private:
  struct Geometry;
  Geometry Place(const CameraModel& camera, const Pose& T_CE, const Optics& optics) const;

  CollarTag tag_;
  BlurredPattern pattern_;
  double cell_m_;
  Eigen::Vector4f Limits(const Pose& T_CE) const;

  std::array<Side, 4> sides_;
  FacePixels pixels_;
};

}  // namespace flextip
