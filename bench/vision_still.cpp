#include "bench/vision_still.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "bench/vision_sequence.h"

namespace flextip {
namespace {

using Eigen::Vector3d;

constexpr double kDepth_m = 0.11, kBehindTip_m = 0.03;
constexpr int kSides = 6;

LaparoscopeOptions Options(const StillCase& one, const CameraCalibration& camera,
                           std::uint64_t seed) {
  LaparoscopeOptions o;
  o.grey = true;
  o.seed = seed;
  o.exposure = 0.7;
  o.exposure_distance_m = kDepth_m;
  o.blur_sigma_px = one.blur_px;
  o.parts_per_px = 3;
  o.full_well_electrons = 0;
  o.tissue.point_R = camera.T_RC * Vector3d(0, 0, kDepth_m + 0.05);
  o.tissue.normal_R = camera.T_RC.R * Vector3d(0.2, -0.3, -1).normalized();
  return o;
}

}  // namespace

struct StillMaker::Impl {
  StillCase one;
  std::uint64_t seed;
  CameraCalibration camera;
  TagCollar collar;
  Laparoscope scope;

  Impl(const StillCase& c, std::uint64_t s)
      : one(c),
        seed(s),
        camera(BenchCamera(c.width_px, c.gamma)),
        collar(
            RingCollar("tag36h11", c.tag_px * kDepth_m / camera.fu_px, kSides, 1.0, kBehindTip_m)),
        scope(camera, collar, Options(c, camera, s)) {}
};

StillMaker::StillMaker(const StillCase& one, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(one, seed)) {}
StillMaker::~StillMaker() = default;
const CameraCalibration& StillMaker::Camera() const { return impl_->camera; }
const TagCollar& StillMaker::Collar() const { return impl_->collar; }

Still StillMaker::Make(int number) const {
  Draw draw(impl_->seed, static_cast<std::uint64_t>(number));
  const Vector3d middle_C =
      kDepth_m * Vector3d(draw.Between(-0.2, 0.2), draw.Between(-0.1, 0.1), 1);
  const double around = draw.Between(0, 2 * std::numbers::pi);
  const double lean = draw.Sign() * impl_->one.angle_deg * std::numbers::pi / 180;
  const double roll = draw.Whole(0, kSides - 1) * 2 * std::numbers::pi / kSides +
                      draw.Between(-20, 20) * std::numbers::pi / 180;
  const Pose T_CE = CollarSeen(middle_C, around, lean, roll, kBehindTip_m);
  const double apothem_m = RingApothem_m("tag36h11", impl_->collar.tags[0].size_m, kSides, 1.0);
  Still still;
  still.grey = impl_->scope.Render(
      ArcShaft(impl_->camera.T_RC * T_CE, 1.0, std::min(0.005, 1.2 * apothem_m)), number);
  std::mt19937_64 random(impl_->seed * 1000003 + static_cast<std::uint64_t>(number));
  std::normal_distribution<double> noise(0, impl_->one.noise_grey);
  for (std::uint8_t& v : still.grey.data) {
    v = static_cast<std::uint8_t>(std::clamp(std::lround(v + noise(random)), 0l, 255l));
  }
  still.truth.T_CE = T_CE;
  // The front tag stands slantwise by the lean and the turn together.
  for (const auto& tag :
       TagsInView(CameraModel(impl_->camera), impl_->collar, T_CE, 80 * std::numbers::pi / 180)) {
    still.truth.corners_px.insert(tag);
  }
  return still;
}

}  // namespace flextip
