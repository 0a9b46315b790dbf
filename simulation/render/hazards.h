// Hazards that hide an instrument from the camera, or make it hard to read: each in frames of its
// own.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/tag_collar.h"
#include "simulation/plant/shaft_curve.h"

namespace flextip::simulation {

/// The frames [first, last].
struct FrameRange {
  int first = 0, last = std::numeric_limits<int>::max();
  bool Has(int frame) const { return frame >= first && frame <= last; }
};

/// Smoke between camera and scene: light * t + light_bgr * (1 - t), with t uneven over the image.
struct Smoke {
  FrameRange frames;
  double transmission = 0.6;                       ///< where the smoke is of mean density; (0, 1]
  Eigen::Vector3d light_bgr = {0.22, 0.22, 0.22};  ///< scattered, as a part of the full well
  double unevenness = 0.6;  ///< density goes from 1 - this to 1 + this; 0 to 1
  double scale_px = 90;     ///< of the coarsest clouds
  double drift_px = 4;      ///< per frame
};

/// The lens out of focus: a Gaussian that grows from 0 to `sigma_px` and shrinks again.
struct Defocus {
  FrameRange frames;  ///< with a last frame
  double sigma_px = 2.0;
  double SigmaAt(int frame) const {
    if (!frames.Has(frame)) return 0.0;
    const double part = (frame - frames.first + 0.5) / (double(frames.last) - frames.first + 1.0);
    return sigma_px * std::sin(std::numbers::pi * part);
  }
};

/// An exposure that jumps, and is led back: 1 + (factor - 1) exp(-frames since / settle_frames).
struct ExposureStep {
  FrameRange frames;
  double factor = 1.6;
  double settle_frames = 0;  ///< 0: the factor stays
  double FactorAt(int frame) const {
    if (!frames.Has(frame)) return 1.0;
    if (settle_frames <= 0) return factor;
    return 1.0 + (factor - 1.0) * std::exp(-(frame - frames.first) / settle_frames);
  }
};

/// A film on a tag's face, with a wavy rim: blood, or a speck of dirt. It moves with the collar and
/// ends at the face's edge.
struct Stain {
  FrameRange frames;
  int tag_id = 0;
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  ///< in the tag's axes G
  double radius_m = 0.001;
  Eigen::Vector3d albedo_bgr = {0.03, 0.03, 0.25};
  double opacity = 1.0;  ///< 1 hides the cells; less mixes their colour in
};

/// Print that is glossy, or wet: highlights on all tags. The surface's normal leans outward from a
/// tag's centre by `bulge_per_m` times the distance, which gives a highlight its place and size.
struct Gloss {
  FrameRange frames;
  double strength = 1.0;  ///< 1 as the steel shaft
  double bulge_per_m = 100;
};

/// Another instrument with tags of its own; it moves without turning.
struct OtherInstrument {
  FrameRange frames;
  TagCollar collar;
  ShaftCurve curve;                                      ///< as in frame `frames.first`
  Eigen::Vector3d velocity_R = Eigen::Vector3d::Zero();  ///< m per frame
};

struct Hazards {
  std::vector<Smoke> smoke;
  std::vector<Defocus> defocus;
  std::vector<ExposureStep> exposure_steps;
  std::vector<Stain> stains;
  std::vector<Gloss> gloss;
  std::vector<OtherInstrument> others;
  std::vector<int> mirrored_tags;  ///< ids that the printer mirrored, left for right

  /// Returns the blur (px, standard deviation) of the lens and of all defocus.
  double BlurAt(int frame, double lens_sigma_px) const {
    double squared = lens_sigma_px * lens_sigma_px;
    for (const Defocus& d : defocus) squared += std::pow(d.SigmaAt(frame), 2);
    return std::sqrt(squared);
  }
  double ExposureAt(int frame) const {
    double factor = 1;
    for (const ExposureStep& e : exposure_steps) factor *= e.FactorAt(frame);
    return factor;
  }
};

}  // namespace flextip::simulation
