// A printed page as a picture, by Poppler's pdftoppm.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>

#include "core/image.h"

namespace flextip {

/// Tells whether pdftoppm is there; tests skip without it.
bool CanRasterise();

/// Returns the part `part_mm` of the first page in grey, at `px_per_mm` picture elements a mm.
Image Rasterise(const std::filesystem::path& pdf, double px_per_mm,
                const Eigen::AlignedBox2d& part_mm);

/// A fresh file name in the test's temporary folder.
std::filesystem::path Scratch(const std::string& name);

}  // namespace flextip
