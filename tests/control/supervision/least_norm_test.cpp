// The least norm beside a search over the ellipsoid's surface.
#include "control/supervision/least_norm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"

namespace flextip {
namespace {

TEST(LeastNorm, IsThatOfASearchOverTheEllipsoid) {
  std::mt19937_64 rng(4);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::Matrix3d root;
    for (int i = 0; i < 3; ++i) root.col(i) = 0.1 * DrawVector<3>(normal, rng);
    const Eigen::Vector3d mean = DrawVector<3>(normal, rng);
    const double found = LeastNorm(mean, root * root.transpose(), 3.0);
    double searched = mean.norm();
    for (int i = 0; i < 200000; ++i) {
      const Eigen::Vector3d on = mean + 3.0 * root * DrawVector<3>(normal, rng).normalized();
      searched = std::min(searched, on.norm());
    }
    if (found == 0.0) {
      // Zero is inside.
      EXPECT_LE((root.inverse() * mean).norm(), 3.0);
    } else {
      EXPECT_LE(found, searched + 1e-9);
      EXPECT_NEAR(found, searched, 0.01);
    }
  }
}

TEST(LeastNorm, AnAxisThatNobodyKnowsCountsForNothing) {
  Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  covariance(0, 0) = 100.0;
  EXPECT_NEAR(LeastNorm({2.0, 0.5, 0.0}, covariance, 3.0), 0.47, 1e-3);
}

TEST(LeastNorm, WithoutDoubtIsTheNorm) {
  EXPECT_EQ(LeastNorm({3, 4, 0}, Eigen::Matrix3d::Zero(), 3.0), 5.0);
  EXPECT_EQ(LeastNorm({std::nan(""), 4, 0}, Eigen::Matrix3d::Identity(), 3.0), 0.0);
}

}  // namespace
}  // namespace flextip
