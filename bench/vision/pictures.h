// Pictures from outside the project, with what is known of them. Absent ones give none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/vision/figures.h"
#include "bench/vision/scene.h"

namespace flextip::bench {

struct Picture {
  std::filesystem::path file;
  PictureTruth truth;
};
struct PictureSet {
  std::string name;
  CameraCalibration camera;
  TagCollar collar;
  std::vector<Picture> pictures;
};

Image ReadGrey(const std::filesystem::path& file);

/// Returns the 8 frames of `recordings`/rendered (testdata/README.md) with the collar's poses.
std::vector<PictureSet> RenderedPictures(const std::filesystem::path& recordings);

/// Photographs with expected corners: those of AprilTag under `data`, and under `visp` (its images'
/// folder) one photograph and one rendered scene, whose corners are known. tag36h11 alone.
std::vector<PictureSet> TagPictures(const std::filesystem::path& data,
                                    const std::filesystem::path& visp);

}  // namespace flextip::bench
