#include "bench/tip_bound/measure.h"

#include <functional>
#include <random>

#include "core/linear_algebra.h"
#include "simulation/render/film.h"
#include "vision/outline/contour.h"
#include "vision/tags/reprojection.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::bench {
namespace {

using Eigen::Vector3d;

constexpr int kWarmUp = 10;
constexpr TimeNs kPeriod_ns = 33'333'333;

struct Sums {
  TipScore score;
  Vector3d error = Vector3d::Zero();
  void Add(const Vector3d& e, const Eigen::Matrix3d& covariance) {
    ++score.found;
    error += e;
    score.rms_m += e.squaredNorm();
    score.nees += MahalanobisSquared(e, covariance);
  }
  TipScore Done() {
    if (score.found == 0) return score;
    score.rms_m = std::sqrt(score.rms_m / score.found);
    score.nees /= score.found;
    score.bias_m = error.norm() / score.found;
    return score;
  }
};

// One rendering, developed with fresh noise as often as asked.
class Exposures {
 public:
  Exposures(const simulation::Laparoscope& laparoscope,
            const simulation::LaparoscopeOptions& options, const TubeShape& tube,
            const BoundScene& scene)
      : light_(laparoscope.RenderLight(CurveOf(scene, tube), 0)),
        film_(options, laparoscope.Gamma()) {}
  Image Take(int number) const { return film_.Develop(light_, number); }

 private:
  simulation::LinearImage light_;
  simulation::render::Film film_;
};

}  // namespace

TipScore MeasureTracker(const simulation::Laparoscope& laparoscope,
                        const simulation::LaparoscopeOptions& options, const TagCollar& collar,
                        const TubeShape& tube, const BoundScene& scene, int frames) {
  const Exposures exposures(laparoscope, options, tube, scene);
  TipTracker tracker(BoundCamera(), collar);
  Sums sums;
  for (int i = -kWarmUp; i < frames; ++i) {
    const TipTrack track = tracker.Track(exposures.Take(i + kWarmUp), (i + kWarmUp) * kPeriod_ns);
    if (i < 0) continue;
    ++sums.score.frames;
    if (track.tip.status != TipStatus::kOk) continue;
    sums.Add(track.tip.p_RE - scene.T_CE.p, track.tip.covariance_m2);
  }
  return sums.Done();
}

TipScore MeasureContour(const simulation::Laparoscope& laparoscope,
                        const simulation::LaparoscopeOptions& options, const TubeShape& tube,
                        const BoundScene& scene, int frames) {
  const Exposures exposures(laparoscope, options, tube, scene);
  ContourOptions contour_options;
  contour_options.blur_px = options.blur_sigma_px;
  contour_options.errors = ContourErrors::LightAtLens();
  const ShaftContour contour(CameraModel(BoundCamera()), tube, contour_options);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Sums sums;
  for (int i = 0; i < frames; ++i) {
    Eigen::Matrix<double, 6, 1> sd, step;
    sd << 0.01, 0.01, 0.01, 5e-4, 5e-4, 2e-3;
    for (int k = 0; k < 6; ++k) step[k] = sd[k] * normal(random);
    const ContourFit fit =
        contour.Fit(exposures.Take(i), MovePose(scene.T_CE, step), sd.cwiseAbs2().asDiagonal());
    ++sums.score.frames;
    if (!fit.IsUsable()) continue;
    sums.Add(fit.T_CE.p - scene.T_CE.p, fit.covariance.bottomRightCorner<3, 3>());
  }
  return sums.Done();
}

}  // namespace flextip::bench
