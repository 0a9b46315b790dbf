// The bound is what an estimate that knows everything else attains on noisy frames.
#include <gtest/gtest.h>

#include "bench/tip_bound/fisher.h"
#include "core/linear_algebra.h"
#include "simulation/render/film.h"
#include "vision/tags/reprojection.h"

namespace flextip::bench {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

simulation::LaparoscopeOptions Scope() {
  simulation::LaparoscopeOptions options = BoundScope(0.7);
  options.parts_per_px = 1;  // nothing here depends on how a lens is drawn
  return options;
}

struct Bounded {
  TagCollar collar = BoundCollar(0.005);
  TubeShape tube = BoundTube(collar);
  simulation::LaparoscopeOptions options = Scope();
  simulation::Laparoscope laparoscope{BoundCamera(), collar, options};
  BoundScene scene = DrawScenes(1, 5).front();
  PixelModels models = ModelPixels(laparoscope, options, collar, tube, scene);
};

const Bounded& OneScene() {
  static const Bounded bounded;
  return bounded;
}

TEST(TipBound, IsAttainedFromTheTrueDerivatives) {
  constexpr int kFrames = 16;
  const Bounded& b = OneScene();
  const simulation::LinearImage light = b.laparoscope.RenderLight(CurveOf(b.scene, b.tube), 0);
  const simulation::render::Film film(b.options, b.laparoscope.Gamma());
  double collar = 0, all = 0;
  for (int i = 0; i < kFrames; ++i) {
    const Image frame = film.Develop(light, i);
    const auto normalised = [&](const PixelModel& model) {
      const Vector6 e = model.Step(frame);
      return e.dot(Ldlt(model.Bound(true).covariance).Solve(e)) / kFrames;
    };
    collar += normalised(b.models.collar);
    all += normalised(b.models.all);
  }
  // 6 expected; the mean of 16 scatters by 0.9.
  EXPECT_NEAR(collar, 6, 2.6);
  EXPECT_NEAR(all, 6, 2.6);
}

// Noise-free frames a tenth of a pixel apart differ by what the derivatives (taken over half a
// pixel) say, up to rounding to 8 bit.
TEST(TipBound, DerivativesFollowTheFrame) {
  const Bounded& b = OneScene();
  simulation::LaparoscopeOptions noise_free = b.options;
  noise_free.full_well_electrons = 0;
  const simulation::render::Film film(noise_free, b.laparoscope.Gamma());
  const PixelModel& model = b.models.all;
  const auto frame_at = [&](const Vector6& move) {
    const BoundScene moved = {MovePose(b.scene.T_CE, move), b.scene.bend};
    simulation::LinearImage light = b.laparoscope.RenderLight(CurveOf(moved, b.tube), 0);
    const Image frame = film.Develop(light, 0);
    Eigen::VectorXd value(model.mean.size());
    for (Eigen::Index r = 0; r < value.size(); ++r) {
      value[r] = model.per_code[r] * frame.data[model.pixels[r]];
    }
    return value;
  };
  const double step_m = 0.1 * b.scene.T_CE.p.z() / BoundCamera().fu_px;
  for (int k = 0; k < 6; ++k) {
    const Vector6 move = (k < 3 ? step_m / 0.03 : (k == 5 ? 5 : 1) * step_m) * Vector6::Unit(k);
    const Eigen::VectorXd change = frame_at(move) - frame_at(-move);
    const Eigen::VectorXd said = 2 * model.J.leftCols<6>() * move;
    EXPECT_NEAR(change.dot(said) / said.squaredNorm(), 1, 0.06) << k;
    EXPECT_GT(change.dot(said), 0.95 * change.norm() * said.norm()) << k;
  }
}

TEST(TipBound, MoreKnownOrMoreSeenBoundsLower) {
  const TipBounds b = BoundTip(OneScene().models);
  EXPECT_LT(b.collar_known.TipRms(), b.collar.TipRms());
  EXPECT_LT(b.all_known.TipRms(), b.all.TipRms());
  EXPECT_LT(b.all_known.TipRms(), b.collar_known.TipRms());
  EXPECT_LT(b.all.TipRms(), b.collar.TipRms());
}

}  // namespace
}  // namespace flextip::bench
