// The lens models for any scalar against vision's, which has derivatives of its own.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <random>

#include "calibration/camera/lens_function.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

template <Distortion kModel, int kTerms>
void AgreesWithVision(std::vector<double> k) {
  CameraCalibration c;
  c.width_px = 640;
  c.height_px = 480;
  c.fu_px = 500;
  c.fv_px = 510;
  c.cu_px = 320;
  c.cv_px = 240;
  c.distortion = kModel;
  c.distortion_coefficients = k;
  const CameraModel model(c);
  std::mt19937 random(kTerms);
  std::uniform_real_distribution<double> u(-0.6, 0.6);
  int tried = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d m =
        i == 0 ? Eigen::Vector2d::Zero() : Eigen::Vector2d(u(random), u(random));
    Eigen::Matrix<double, 2, 3> J;
    const auto px = model.Project({m.x(), m.y(), 1.0}, &J);
    if (!px) continue;
    ++tried;
    using Jet = ceres::Jet<double, 2>;
    Jet coefficients[kTerms];
    for (int j = 0; j < kTerms; ++j) coefficients[j] = Jet(k[static_cast<std::size_t>(j)]);
    const auto d = DistortLens<kModel, kTerms>(
        coefficients, Eigen::Matrix<Jet, 2, 1>(Jet(m.x(), 0), Jet(m.y(), 1)));
    EXPECT_NEAR(500 * d.x().a + 320, px->x(), 1e-9);
    EXPECT_NEAR(510 * d.y().a + 240, px->y(), 1e-9);
    EXPECT_TRUE((500 * d.x().v.transpose()).isApprox(J.row(0).head<2>(), 1e-9));
    EXPECT_TRUE((510 * d.y().v.transpose()).isApprox(J.row(1).head<2>(), 1e-9));
  }
  EXPECT_GT(tried, 150);
}

TEST(LensFunction, AgreesWithVision) {
  AgreesWithVision<Distortion::kRadialTangential, 4>({-0.3, 0.1, 0.001, -0.002});
  AgreesWithVision<Distortion::kOpenCv, 5>({-0.3, 0.1, 0.001, -0.002, -0.01});
  AgreesWithVision<Distortion::kOpenCv, 8>({0.1, -0.2, 0.001, -0.002, 0.05, 0.3, -0.1, 0.02});
  AgreesWithVision<Distortion::kOpenCv, 12>(
      {0.1, -0.2, 0.001, -0.002, 0.05, 0.3, -0.1, 0.02, 0.01, -0.02, 0.03, -0.04});
  AgreesWithVision<Distortion::kEquidistant, 4>({0.05, -0.02, 0.01, -0.003});
}

}  // namespace
}  // namespace flextip
