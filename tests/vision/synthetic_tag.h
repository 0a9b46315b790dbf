// Pictures of tags with corners that are known exactly: area-sampled, blurred, noisy.
#pragma once

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "vision/tags/detector.h"

namespace flextip {

struct PlacedTag {
  int id = 0;
  double size_m = 0.0;
  Pose T_CG;
};

struct SyntheticOptions {
  double dark = 30, bright = 210, background = 90;  // grey levels
  double blur_px = 0.7;                             // Gaussian
  double noise = 2.0;                               // grey levels
  double margin_cells = 1;                          // white around the tag
  double shading = 0.0;  // relative change of the light across the picture's width
  unsigned seed = 1;
};

/// The tags (family tag36h11, drawn in the given order) as the camera sees them.
Image RenderTags(const CameraCalibration& camera, const std::vector<PlacedTag>& tags,
                 const SyntheticOptions& options = {});

/// The tags of a collar at T_CE that face the camera.
std::vector<PlacedTag> FacingTags(const TagCollar& collar, const Pose& T_CE,
                                  double max_angle_rad = 1.2);

/// `count` tags around a shaft along x of E, `centre_x_m` from the tip, faces at `apothem_m`.
TagCollar PrismCollar(int count, double size_m, double apothem_m, double centre_x_m);

/// Pixels of the tag's corners in the order of TagDetection.
std::vector<Eigen::Vector2d> TrueCorners(const CameraCalibration& camera, const PlacedTag& tag);

/// What a detector would say of a collar: the tags that face the camera, noise on their corners.
std::vector<TagDetection> NoisyTags(const CameraCalibration& camera, const TagCollar& collar,
                                    const Pose& T_CE, double noise_px, std::mt19937& random,
                                    double max_angle_rad = 1.1);

CameraCalibration TestCamera(bool distorted);

}  // namespace flextip
