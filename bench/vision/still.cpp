#include "bench/vision/still.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "bench/vision/sequence.h"

namespace flextip::bench {
namespace {

using Eigen::Vector3d;

constexpr double kDepth_m = 0.11, kBehindTip_m = 0.03;
constexpr int kSides = 6;

simulation::LaparoscopeOptions Options(const StillCase& one, const CameraCalibration& camera,
                                       std::uint64_t seed) {
  simulation::LaparoscopeOptions o;
  o.grey = true;
  o.seed = seed;
  o.exposure = 0.7;
  o.exposure_distance_m = kDepth_m;
  o.blur_sigma_px = one.blur_px;
  o.parts_per_px = 3;
  o.tissue.point_R = camera.T_RC * Vector3d(0, 0, kDepth_m + 0.05);
  o.tissue.normal_R = camera.T_RC.R * Vector3d(0.2, -0.3, -1).normalized();
  return o;
}

}  // namespace

struct StillMaker::Impl {
  std::uint64_t seed;
  StillCase one;
  CameraCalibration camera;
  TagCollar collar;
  std::optional<simulation::Laparoscope> scope;
};

StillMaker::StillMaker(std::uint64_t seed) : impl_(std::make_unique<Impl>()) { impl_->seed = seed; }
StillMaker::~StillMaker() = default;
const TagCollar& StillMaker::Collar() const { return impl_->collar; }

CameraCalibration StillMaker::Camera(double gamma) const {
  return BenchCamera(impl_->one.width_px, gamma);
}

void StillMaker::Show(const StillCase& one) {
  const StillCase before = impl_->one;
  impl_->one = one;
  if (impl_->scope && one.width_px == before.width_px && one.tag_px == before.tag_px &&
      one.blur_px == before.blur_px) {
    return;
  }
  impl_->camera = Camera(1);
  const double size_m = one.tag_px * kDepth_m / impl_->camera.fu_px;
  impl_->collar = RingCollar("tag36h11", size_m, kSides, 1.0, kBehindTip_m);
  impl_->scope.emplace(impl_->camera, impl_->collar, Options(one, impl_->camera, impl_->seed));
}

Still StillMaker::Make(int number) const {
  Draw draw(impl_->seed, static_cast<std::uint64_t>(number));
  const double down = draw.Between(-0.1, 0.1), across = draw.Between(-0.2, 0.2);
  const Vector3d middle_C = kDepth_m * Vector3d(across, down, 1);
  const double around = draw.Between(0, 2 * std::numbers::pi);
  const double lean = draw.Sign() * impl_->one.angle_deg * std::numbers::pi / 180;
  const double roll = draw.Whole(0, kSides - 1) * 2 * std::numbers::pi / kSides +
                      draw.Between(-20, 20) * std::numbers::pi / 180;
  const Pose T_CE = CollarSeen(middle_C, around, lean, roll, kBehindTip_m);
  const double apothem_m = RingApothem_m("tag36h11", impl_->collar.tags[0].size_m, kSides, 1.0);
  const simulation::ShaftCurve shaft =
      ArcShaft(impl_->camera.T_RC * T_CE, 1.0, std::min(0.005, 1.2 * apothem_m));
  Still still{impl_->scope->RenderLight(shaft, number), {{}, T_CE}};
  // The front tag stands slantwise by the lean and the turn together.
  for (const auto& tag :
       TagsInView(CameraModel(impl_->camera), impl_->collar, T_CE, 80 * std::numbers::pi / 180)) {
    still.truth.corners_px.insert(tag);
  }
  return still;
}

Image StillMaker::Film(const simulation::LinearImage& light, double gamma, int number) const {
  std::mt19937_64 random(impl_->seed * 1000003 + static_cast<std::uint64_t>(number));
  std::normal_distribution<double> noise(0, impl_->one.noise_grey);
  Image grey(light.width_px, light.height_px, 1);
  for (std::size_t i = 0; i < grey.data.size(); ++i) {
    const double v = 255 * std::pow(std::clamp<double>(light.data[i], 0, 1), 1 / gamma);
    grey.data[i] = static_cast<std::uint8_t>(std::clamp(std::lround(v + noise(random)), 0l, 255l));
  }
  return grey;
}

}  // namespace flextip::bench
