// The laparoscope: its camera's view of the shaft, the tag collar and the tissue, as 8-bit video.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/tag_collar.h"
#include "simulation/plant/shaft_curve.h"
#include "simulation/render/hazards.h"

namespace flextip::simulation {

/// The tissue: a plane with gentle relief and a procedural texture.
struct TissueOptions {
  Eigen::Vector3d point_R = Eigen::Vector3d::Zero();    ///< a point of the mean plane (m)
  Eigen::Vector3d normal_R = Eigen::Vector3d::UnitZ();  ///< out of the tissue; any length but 0
  Eigen::Vector3d albedo_bgr = {0.29, 0.34, 0.88};      ///< mean reflectance, 0 to 1; 0 is black
  double relief_m = 0.0015;                             ///< standard height of the relief; 0: flat
  double texture_scale_m = 0.012;                       ///< size of the coarsest patches
  double texture_contrast = 1.0;                        ///< 0: one colour
  double wetness = 1.0;                                 ///< strength of the specular spots
};

/// Something between the camera and the instrument, seen in the frames [first_frame, last_frame].
struct Occluder {
  enum class Kind {
    kCapsule,  ///< from a_R to b_R with `radius_m`: another instrument's shaft (metal) or a blob
    kDisc,  ///< a flat patch with a wavy rim at a_R, its normal toward b_R: blood on the lens side
  };
  Kind kind = Kind::kCapsule;
  Eigen::Vector3d a_R = Eigen::Vector3d::Zero(), b_R = Eigen::Vector3d::Zero();  ///< m
  double radius_m = 0.0025;
  Eigen::Vector3d albedo_bgr = {0.02, 0.02, 0.25};
  double specular = 0.05;                                ///< 0 matt, 1 as the metal shaft
  Eigen::Vector3d velocity_R = Eigen::Vector3d::Zero();  ///< m per frame, from first_frame on
  int first_frame = 0, last_frame = std::numeric_limits<int>::max();
};

/// Order of the image's making: linear radiance, smoke, exposure, blur, means over the pixels, shot
/// and read noise, clipping at the full well, gamma, 8 bit.
struct LaparoscopeOptions {
  TissueOptions tissue;
  std::vector<Occluder> occluders;
  Hazards hazards;
  double exposure = 0.33;          ///< signal, as a part of the full well, of a white matt surface
                                   ///< that faces the scope on its axis at `exposure_distance_m`
  double exposure_distance_m = 0;  ///< 0: the distance of the tissue along the optical axis, or
                                   ///< 0.1 m where the axis misses the tissue
  double vignetting = 2.0;         ///< the light falls as cos(angle off the axis) to this power
  double blur_sigma_px = 0.7;      ///< of the lens, Gaussian; 0: none
  /// The blur is computed on a grid that many times finer than the pixels, 1 to 4. At 1 it follows
  /// the pixels in place of preceding them: an edge blurred by 0.6 px is off by 4 % of its contrast
  /// in some pixels, below 1 % at 4. Time and memory grow with the square.
  int parts_per_px = 1;
  double full_well_electrons = 15000;  ///< shot noise: variance = mean, in electrons; 0: none
  double read_noise_electrons = 15;
  double gamma = 2.2;  ///< 8-bit value = 255 signal^(1/gamma); used where the calibration has none
  bool grey = false;   ///< one channel instead of blue, green, red
  std::uint64_t seed = 1;  ///< of the noise and of the tissue's texture
};

/// Linear light, as a part of the full well, before noise; not clipped.
struct LinearImage {
  int width_px = 0, height_px = 0, channels = 3;
  std::vector<float> data;  ///< rows of interleaved channels (blue, green, red, or grey)
  const float* At(int x, int y) const {
    return data.data() + (static_cast<std::size_t>(y) * width_px + x) * channels;
  }
  float* At(int x, int y) {
    return data.data() + (static_cast<std::size_t>(y) * width_px + x) * channels;
  }
};

/// Renders frames of the scene. The light is at the camera's centre (a ring around the lens), so
/// no shadow is seen; it falls off with the square of the distance. Construction takes about a
/// second (rays and tissue are computed once); frames are safe to render from several threads.
class Laparoscope {
 public:
  /// @throws InputError for a tag family or id that does not exist, a camera without pixels or with
  ///   a wrong number of distortion coefficients, or options outside their range.
  Laparoscope(const CameraCalibration& camera, const TagCollar& collar,
              const LaparoscopeOptions& options);
  ~Laparoscope();
  Laparoscope(Laparoscope&&) noexcept;
  Laparoscope& operator=(Laparoscope&&) noexcept;

  /// Returns the frame as the camera gives it. The same seed, number and curve give the same bytes.
  Image Render(const ShaftCurve& curve, int frame_number) const;

  /// Returns the frame with motion blur: the linear light's mean over the exposure, in which the
  /// shaft takes the shapes `during_exposure` (at least one; at equal steps of time). Nothing else
  /// moves meanwhile.
  Image Render(std::span<const ShaftCurve> during_exposure, int frame_number) const;

  /// Returns the noise-free linear light in each pixel (its mean over the pixel's area), smoke and
  /// exposure included, as a lens without blur would give it.
  LinearImage RenderLinear(const ShaftCurve& curve, int frame_number) const;

  /// Returns the same behind the lens that blurs: the light on the film.
  LinearImage RenderLight(const ShaftCurve& curve, int frame_number) const;

  /// Returns the exponent in use: the calibration's where it has one.
  double Gamma() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip::simulation
