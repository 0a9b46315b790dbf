// The lens: blur of the light before the pixels take their means.
#pragma once

#include "core/camera.h"
#include "simulation/render/laparoscope.h"

namespace flextip::simulation::render {

/// A sensor with `parts` x `parts` pixels in place of each of the camera's.
CameraCalibration Finer(const CameraCalibration& camera, int parts);

/// A Gaussian of `sigma_px` of the image's own pixels, in place.
void Blur(LinearImage& light, double sigma_px);

/// The means over squares of `parts` x `parts` pixels.
LinearImage MeansOver(const LinearImage& fine, int parts);

}  // namespace flextip::simulation::render
