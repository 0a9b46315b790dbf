// The lens models with their derivatives: against vision's, and against central differences.
#include "calibration/camera/lens_derivative.h"

#include <gtest/gtest.h>

#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

void AgreesWithVision(Distortion distortion, const std::vector<double>& k) {
  CameraCalibration c;
  c.width_px = 640;
  c.height_px = 480;
  c.fu_px = 500;
  c.fv_px = 510;
  c.cu_px = 320;
  c.cv_px = 240;
  c.distortion = distortion;
  c.distortion_coefficients = k;
  const CameraModel model(c);
  const int terms = static_cast<int>(k.size());
  std::mt19937 random(static_cast<unsigned>(terms));
  std::uniform_real_distribution<double> u(-0.6, 0.6);
  int tried = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d m = i == 0 ? Eigen::Vector2d::Zero() : DrawVector<2>(u, random);
    Eigen::Matrix<double, 2, 3> J;
    const auto px = model.Project({m.x(), m.y(), 1.0}, &J);
    if (!px) continue;
    ++tried;
    const LensDerivative lens = DifferentiateLens(distortion, k.data(), terms, m);
    EXPECT_NEAR(500 * lens.d.x() + 320, px->x(), 1e-9);
    EXPECT_NEAR(510 * lens.d.y() + 240, px->y(), 1e-9);
    EXPECT_TRUE((500 * lens.by_m.row(0)).isApprox(J.row(0).head<2>(), 1e-9));
    EXPECT_TRUE((510 * lens.by_m.row(1)).isApprox(J.row(1).head<2>(), 1e-9));
    const Eigen::MatrixXd by_k = NumericJacobian(
        [&](const Eigen::VectorXd& moved) -> Eigen::VectorXd {
          return DifferentiateLens(distortion, moved.data(), terms, m).d;
        },
        Eigen::Map<const Eigen::VectorXd>(k.data(), terms), 1e-4);
    EXPECT_LT((lens.by_k.leftCols(terms) - by_k).cwiseAbs().maxCoeff(), 1e-10);
  }
  EXPECT_GT(tried, 150);
}

TEST(LensDerivative, AgreesWithVisionAndWithDifferences) {
  AgreesWithVision(Distortion::kRadialTangential, {-0.3, 0.1, 0.001, -0.002});
  AgreesWithVision(Distortion::kOpenCv, {-0.3, 0.1, 0.001, -0.002, -0.01});
  AgreesWithVision(Distortion::kOpenCv, {0.1, -0.2, 0.001, -0.002, 0.05, 0.3, -0.1, 0.02});
  AgreesWithVision(Distortion::kOpenCv,
                   {0.1, -0.2, 0.001, -0.002, 0.05, 0.3, -0.1, 0.02, 0.01, -0.02, 0.03, -0.04});
  AgreesWithVision(Distortion::kEquidistant, {0.05, -0.02, 0.01, -0.003});
}

}  // namespace
}  // namespace flextip
