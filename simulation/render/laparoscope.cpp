#include "simulation/render/laparoscope.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "core/check.h"
#include "core/error.h"
#include "simulation/render/film.h"
#include "simulation/render/lens.h"
#include "simulation/render/raster.h"
#include "simulation/render/rays.h"
#include "simulation/render/scene.h"
#include "simulation/render/tissue_texture.h"
#include "simulation/render/veil.h"
#include "vision/camera_model.h"

namespace flextip::simulation {
namespace {

constexpr double kDistanceWithoutTissue_m = 0.1;
constexpr std::size_t kMaxOccluders = 24, kMaxStains = 16;

void Require(bool condition, const char* name, double found, const char* expected) {
  if (condition) return;
  throw InputError(fmt::format("laparoscope: {}: found {}, expected {}", name, found, expected));
}

void Check(const Hazards& hazards) {
  for (const Smoke& s : hazards.smoke) {
    Require(s.transmission > 0 && s.transmission <= 1, "smoke: transmission", s.transmission,
            "above 0, 1 at most");
    Require(s.unevenness >= 0 && s.unevenness <= 1, "smoke: unevenness", s.unevenness, "0 to 1");
    Require(s.scale_px > 0, "smoke: scale", s.scale_px, "> 0 px");
  }
  for (const Defocus& d : hazards.defocus) {
    Require(d.sigma_px >= 0 && d.sigma_px < 50, "defocus: sigma", d.sigma_px, "0 to 50 px");
  }
  for (const ExposureStep& e : hazards.exposure_steps) {
    Require(std::isfinite(e.factor) && e.factor > 0, "exposure step", e.factor, "> 0");
  }
  for (const Stain& s : hazards.stains) {
    Require(s.radius_m > 0, "stain: radius", s.radius_m, "> 0");
    Require(s.opacity >= 0 && s.opacity <= 1, "stain: opacity", s.opacity, "0 to 1");
  }
  Require(hazards.stains.size() <= kMaxStains, "number of stains",
          static_cast<double>(hazards.stains.size()), "16 at most");
  Require(hazards.others.size() <= 1, "number of other instruments",
          static_cast<double>(hazards.others.size()), "1 at most");
}

void Check(const CameraCalibration& camera, const LaparoscopeOptions& o) {
  Require(camera.width_px > 0 && camera.height_px > 0, "image width", camera.width_px, "> 0");
  Require(std::isfinite(o.exposure) && o.exposure > 0, "exposure", o.exposure, "> 0");
  Require(o.exposure_distance_m >= 0, "exposure distance", o.exposure_distance_m, ">= 0");
  Require(o.vignetting >= 0, "vignetting", o.vignetting, ">= 0");
  Require(o.blur_sigma_px >= 0 && o.blur_sigma_px < 50, "blur", o.blur_sigma_px, "0 to 50 px");
  Require(o.parts_per_px >= 1 && o.parts_per_px <= 4, "parts per pixel", o.parts_per_px, "1 to 4");
  Require(o.full_well_electrons >= 0, "full well", o.full_well_electrons, ">= 0");
  Require(o.read_noise_electrons >= 0, "read noise", o.read_noise_electrons, ">= 0");
  const double gamma = camera.gamma.value_or(o.gamma);
  Require(gamma > 0.1 && gamma < 10, "gamma", gamma, "0.1 to 10");
  Require(o.tissue.normal_R.norm() > 0, "tissue normal's length", o.tissue.normal_R.norm(), "> 0");
  Require(o.tissue.relief_m >= 0, "tissue relief", o.tissue.relief_m, ">= 0");
  Require(o.tissue.texture_scale_m > 0, "texture scale", o.tissue.texture_scale_m, "> 0");
  Require(o.occluders.size() <= kMaxOccluders, "number of occluders",
          static_cast<double>(o.occluders.size()), "24 at most");
  for (const Occluder& occluder : o.occluders) {
    Require(occluder.radius_m > 0, "occluder radius", occluder.radius_m, "> 0");
    const double length = (occluder.b_R - occluder.a_R).norm();
    Require(length > 0, "occluder: distance of a and b", length, "> 0");
  }
  Check(o.hazards);
}

// The light's strength that gives the exposure asked for.
render::Light MakeLight(const CameraCalibration& camera, const LaparoscopeOptions& o) {
  double distance_m = o.exposure_distance_m;
  if (distance_m == 0) {
    const double along = o.tissue.normal_R.dot(camera.T_RC.R.col(2));
    const double away = o.tissue.normal_R.dot(o.tissue.point_R - camera.T_RC.p);
    distance_m = along * away > 0 ? away / along : kDistanceWithoutTissue_m;
  }
  return {o.exposure * distance_m * distance_m, o.vignetting};
}

LinearImage ToGrey(const LinearImage& colour) {
  LinearImage grey{colour.width_px, colour.height_px, 1, {}};
  grey.data.resize(colour.data.size() / 3);
  for (std::size_t i = 0; i < grey.data.size(); ++i) {
    const float* bgr = &colour.data[3 * i];
    grey.data[i] = 0.0722f * bgr[0] + 0.7152f * bgr[1] + 0.2126f * bgr[2];  // ITU-R BT.709
  }
  return grey;
}

}  // namespace

struct Laparoscope::Impl {
  Impl(const CameraCalibration& calibration, const TagCollar& tags, const LaparoscopeOptions& o)
      : options((Check(calibration, o), o)),
        camera(render::Finer(calibration, o.parts_per_px)),
        collar(tags, o.hazards.mirrored_tags),
        rays(camera.Calibration()),
        light(MakeLight(calibration, o)),
        film(o, calibration.gamma.value_or(o.gamma)) {
    for (const OtherInstrument& other : o.hazards.others) {
      other_collars.emplace_back(other.collar, std::vector<int>{});
    }
    DrawTissue();
  }

  void DrawTissue() {
    const TissueTexture texture(options.tissue, camera.Calibration().T_RC, options.seed);
    tissue = {rays.WidthPx(), rays.HeightPx(), 3, {}};
    tissue.data.assign(static_cast<std::size_t>(tissue.width_px) * tissue.height_px * 3, 0.0f);
    tbb::parallel_for(0, tissue.height_px, [&](int y) {
      for (int x = 0; x < tissue.width_px; ++x) {
        if (!rays.Valid(x, y)) continue;
        double depth = 0;
        Eigen::Map<Eigen::Vector3f> colour(tissue.At(x, y));
        colour = texture.Radiance(rays.At(x, y).Centre(), light, depth);
      }
    });
  }

  void AddAir(LinearImage& image, int frame_number) const {
    render::DrawSmoke(options.hazards.smoke, frame_number, options.seed, options.parts_per_px,
                      image);
    const auto exposure = static_cast<float>(options.hazards.ExposureAt(frame_number));
    if (exposure == 1.0f) return;
    for (float& v : image.data) v *= exposure;
  }

  /// On the fine grid, before the lens.
  LinearImage Draw(const ShaftCurve& curve, int frame_number) const;

  /// What falls on the film.
  LinearImage ThroughLens(LinearImage fine, int frame_number) const {
    const int parts = options.parts_per_px;
    render::Blur(fine, parts * options.hazards.BlurAt(frame_number, options.blur_sigma_px));
    return parts == 1 ? std::move(fine) : render::MeansOver(fine, parts);
  }

  LaparoscopeOptions options;
  CameraModel camera;  // of the fine grid
  render::CollarBody collar;
  std::vector<render::CollarBody> other_collars;
  render::PixelRays rays;
  render::Light light;
  render::Film film;
  LinearImage tissue;
};

Laparoscope::Laparoscope(const CameraCalibration& camera, const TagCollar& collar,
                         const LaparoscopeOptions& options)
    : impl_(std::make_unique<Impl>(camera, collar, options)) {}
Laparoscope::~Laparoscope() = default;
Laparoscope::Laparoscope(Laparoscope&&) noexcept = default;
Laparoscope& Laparoscope::operator=(Laparoscope&&) noexcept = default;

LinearImage Laparoscope::Impl::Draw(const ShaftCurve& curve, int frame_number) const {
  FLEXTIP_CHECK(curve.points.size() >= 2 && curve.diameter_m > 0,
                "a curve has two points and a diameter");
  render::Scene scene(camera, frame_number);
  scene.AddInstrument(curve, collar, options.hazards);
  for (std::size_t i = 0; i < other_collars.size(); ++i) {
    scene.AddOther(options.hazards.others[i], other_collars[i]);
  }
  for (const Occluder& occluder : options.occluders) scene.AddOccluder(occluder);
  scene.Finish();
  LinearImage image = tissue;
  render::Raster(rays, scene, light).Draw(image);
  AddAir(image, frame_number);
  return options.grey ? ToGrey(image) : image;
}

LinearImage Laparoscope::RenderLinear(const ShaftCurve& curve, int frame_number) const {
  LinearImage light = impl_->Draw(curve, frame_number);
  const int parts = impl_->options.parts_per_px;
  return parts == 1 ? light : render::MeansOver(light, parts);
}

LinearImage Laparoscope::RenderLight(const ShaftCurve& curve, int frame_number) const {
  return impl_->ThroughLens(impl_->Draw(curve, frame_number), frame_number);
}

Image Laparoscope::Render(const ShaftCurve& curve, int frame_number) const {
  return Render(std::span(&curve, 1), frame_number);
}

Image Laparoscope::Render(std::span<const ShaftCurve> during_exposure, int frame_number) const {
  FLEXTIP_CHECK(!during_exposure.empty(), "an exposure has an instant");
  LinearImage light = impl_->Draw(during_exposure.front(), frame_number);
  for (const ShaftCurve& curve : during_exposure.subspan(1)) {
    const LinearImage more = impl_->Draw(curve, frame_number);
    for (std::size_t i = 0; i < light.data.size(); ++i) light.data[i] += more.data[i];
  }
  const float part = 1.0f / static_cast<float>(during_exposure.size());
  if (during_exposure.size() > 1) {
    for (float& v : light.data) v *= part;
  }
  return impl_->film.Develop(impl_->ThroughLens(std::move(light), frame_number), frame_number);
}

double Laparoscope::Gamma() const {
  return impl_->camera.Calibration().gamma.value_or(impl_->options.gamma);
}

}  // namespace flextip::simulation
