// The correction's formula, as docs/formats.md has it.
#include "recording/calibrations/em_field.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace flextip {
namespace {

TEST(EmField, NoCoefficientsLeaveThePosition) {
  EXPECT_EQ(ApplyField({}, {1, 2, 3}), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(FieldCovers({}, {1, 2, 3}));
  EXPECT_THROW(ApplyField({.coefficients = {1, 2, 3}}, {0, 0, 0}), InputError);
}

TEST(EmField, PolynomialsCountTheirTermsAsDocumented) {
  FieldCorrection field{std::vector<double>(57, 0.0), {0.1, 0.2, 0.3}, {0.5, 0.4, 0.2}};
  const Eigen::Vector3d p(0.3, 0.1, 0.35), u(0.4, -0.25, 0.25);
  // Degree 1: u1 is the second; degree 2: u0 u2 the sixth; degree 3: u0 u1 u2 the fourteenth.
  field.coefficients[3 * 1 + 0] = 0.01;
  field.coefficients[3 * 5 + 1] = 0.02;
  field.coefficients[3 * 13 + 2] = 0.03;
  const Eigen::Vector3d expected =
      p + Eigen::Vector3d(0.01 * u[1], 0.02 * u[0] * u[2], 0.03 * u[0] * u[1] * u[2]);
  EXPECT_LT((ApplyField(field, p) - expected).norm(), 1e-15);
}

// B-splines make polynomials up to the third degree exactly: sums of one, and places of themselves.
TEST(EmField, SplinesMakeConstantsAndLines) {
  for (int n = 4; n <= 8; ++n) {
    FieldCorrection field;
    field.scale_m = {0.2, 0.3, 0.4};
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        for (int l = 0; l < n; ++l) {
          for (const int at : {i, j, l}) {
            field.coefficients.push_back(2.0 * (at - 1) / (n - 3) - 1.0);
          }
        }
      }
    }
    const Eigen::Vector3d u(0.31, -0.77, 1.0);
    const Eigen::Vector3d p = u.cwiseProduct(field.scale_m);
    EXPECT_LT((ApplyField(field, p) - p - u).norm(), 1e-14) << n;
  }
}

TEST(EmField, BeyondTheBoxTheNearestCorrectionIsTaken) {
  FieldCorrection field{std::vector<double>(9, 0.0), {0, 0, 0}, {0.1, 0.1, 0.1}};
  field.coefficients[0] = 0.002;
  const Eigen::Vector3d far(0.5, 0.05, 0.0);
  EXPECT_FALSE(FieldCovers(field, far));
  EXPECT_LT((ApplyField(field, far) - far - Eigen::Vector3d(0.002, 0, 0)).norm(), 1e-15);
  EXPECT_TRUE(FieldCovers(field, {0.1, -0.1, 0.0}));
}

}  // namespace
}  // namespace flextip
