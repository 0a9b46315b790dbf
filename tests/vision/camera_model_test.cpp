// The camera model against OpenCV's projection and central differences.
#include "vision/camera_model.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

#include "core/derivative_check.h"
#include "core/error.h"
#include "tests/vision/optics_reference.h"

namespace flextip {
namespace {

CameraCalibration Plain() {
  CameraCalibration c;
  c.width_px = 1280;
  c.height_px = 720;
  c.fu_px = 950;
  c.fv_px = 940;
  c.cu_px = 646.5;
  c.cv_px = 355.5;
  return c;
}

Eigen::Vector2d ByOpenCv(const CameraCalibration& c, const Eigen::Vector3d& x) {
  const cv::Matx33d K(c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1);
  const std::vector<cv::Point3d> points{{x.x(), x.y(), x.z()}};
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d zero(0, 0, 0);
  if (c.distortion == Distortion::kEquidistant) {
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, c.distortion_coefficients);
  } else {
    cv::projectPoints(points, zero, zero, K, c.distortion_coefficients, pixels);
  }
  return {pixels[0].x, pixels[0].y};
}

// Points that fall inside a picture a little larger than the camera's.
std::vector<Eigen::Vector3d> Points(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-0.7, 0.7), y(-0.45, 0.45), z(0.05, 0.5);
  std::vector<Eigen::Vector3d> points{{0, 0, 0.1}, {1e-9, -1e-9, 0.2}, {1e-5, 2e-5, 0.1}};
  while (static_cast<int>(points.size()) < count) {
    const double depth = z(random);
    const double across = y(random), along = x(random);
    points.emplace_back(along * depth, across * depth, depth);
  }
  return points;
}

TEST(CameraModel, AgreesWithOpenCv) {
  for (const CameraCalibration& c : WithEachLens(Plain())) {
    const CameraModel model(c);
    for (const Eigen::Vector3d& x : Points(1, 300)) {
      const auto px = model.Project(x);
      ASSERT_TRUE(px) << x.transpose();
      EXPECT_LT((*px - ByOpenCv(c, x)).norm(), 1e-9);
    }
  }
}

TEST(CameraModel, JacobianAgreesWithCentralDifferences) {
  for (const CameraCalibration& c : WithEachLens(Plain())) {
    const CameraModel model(c);
    for (const Eigen::Vector3d& x : Points(2, 100)) {
      Eigen::Matrix<double, 2, 3> J;
      ASSERT_TRUE(model.Project(x, &J));
      const auto f = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return *model.Project(Eigen::Vector3d(at));
      };
      EXPECT_LT((J - NumericJacobian(f, x, 1e-5)).norm(), 1e-6 * J.norm()) << x.transpose();
    }
  }
}

TEST(CameraModel, RoundTripOverTheWholePicture) {
  for (const CameraCalibration& c : WithEachLens(Plain())) {
    const CameraModel model(c);
    for (double v = 0; v < c.height_px; v += 23.7) {
      for (double u = 0; u < c.width_px; u += 31.3) {
        const auto ray = model.Unproject({u, v});
        ASSERT_TRUE(ray) << u << " " << v;
        EXPECT_NEAR(ray->norm(), 1.0, 1e-12);
        const auto px = model.Project(0.3 * *ray);
        ASSERT_TRUE(px);
        EXPECT_LT((*px - Eigen::Vector2d(u, v)).norm(), 1e-9);
      }
    }
    const auto axis = model.Unproject({c.cu_px, c.cv_px});
    ASSERT_TRUE(axis);
    EXPECT_GT(axis->z(), 1 - 1e-6);
  }
}

TEST(CameraModel, NothingBehindTheCamera) {
  for (const CameraCalibration& c : WithEachLens(Plain())) {
    const CameraModel model(c);
    EXPECT_FALSE(model.Project({0.01, 0.01, -0.1}));
    EXPECT_FALSE(model.Project({0.01, 0.01, 0.0}));
    EXPECT_FALSE(model.Project({0.01, 0.01, std::nan("")}));
  }
}

TEST(CameraModel, NothingBeyondTheTurningPointOfTheDistortion) {
  // r (1 - 0.3 r^2) turns at r = sqrt(1/0.9) and reaches 2/3 r there.
  const CameraModel model(WithLens(Plain(), Distortion::kRadialTangential, {-0.3, 0, 0, 0}));
  const double r = std::sqrt(1.0 / 0.9);
  EXPECT_NEAR(std::tan(model.MaxAngle()), r, 1e-9);
  EXPECT_TRUE(model.Project({0.999 * r, 0, 1}));
  EXPECT_FALSE(model.Project({1.001 * r, 0, 1}));
  const double edge_px = 646.5 + 950 * r * 2 / 3;
  EXPECT_TRUE(model.Unproject({edge_px - 0.5, 355.5}));
  EXPECT_FALSE(model.Unproject({edge_px + 0.5, 355.5}));
}

TEST(CameraModel, RejectsAWrongNumberOfCoefficients) {
  EXPECT_THROW(CameraModel(WithLens(Plain(), Distortion::kRadialTangential, {0, 0, 0, 0, 0})),
               InputError);
  EXPECT_THROW(CameraModel(WithLens(Plain(), Distortion::kOpenCv, {0, 0, 0, 0})), InputError);
  EXPECT_THROW(CameraModel(WithLens(Plain(), Distortion::kEquidistant, {0, 0})), InputError);
  EXPECT_THROW(CameraModel(WithLens(Plain(), Distortion::kOpenCv, {0, 0, 0, 0, std::nan("")})),
               InputError);
  CameraCalibration no_focal = WithLens(Plain(), Distortion::kEquidistant, {0, 0, 0, 0});
  no_focal.fu_px = 0;
  EXPECT_THROW(CameraModel{no_focal}, InputError);
}

}  // namespace
}  // namespace flextip
