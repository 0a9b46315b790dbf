// The blurred pattern against integration of the cells under the normal distribution.
#include "vision/photometric/blurred_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "tests/vision/optics_reference.h"
#include "vision/photometric/pattern_lanes.h"
#include "vision/photometric/tag_blur.h"

namespace flextip {
namespace {

// Beyond the tag its outermost cells go on.
bool IsWhite(const TagCells& tag, int column, int row) {
  return tag.At(std::clamp(column, 0, tag.cells - 1), std::clamp(row, 0, tag.cells - 1)) ==
         TagCells::kWhite;
}

// The mean of the pattern: along u by the midpoint rule within each column, along v, given u,
// exactly.
double Mean(const TagCells& tag, double u, double v, double su, double sv, double rho) {
  constexpr double kTail = 6.5, kStep = 0.02;
  const double s = sv * std::sqrt(1 - rho * rho);
  double sum = 0;
  for (int column = -8; column < tag.cells + 8; ++column) {
    const double from = std::max(-kTail, (column - u) / su);
    const double to = std::min(kTail, (column + 1 - u) / su);
    const int steps = static_cast<int>(std::ceil((to - from) / kStep));
    for (int i = 0; i < steps; ++i) {
      const double x = from + (i + 0.5) * (to - from) / steps, centre = v + rho * sv * x;
      double white = 0;
      for (int row = -8; row < tag.cells + 8; ++row) {
        if (!IsWhite(tag, column, row)) continue;
        white += NormalCdf((row + 1 - centre) / s) - NormalCdf((row - centre) / s);
      }
      sum += std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI) * white * (to - from) / steps;
    }
  }
  return sum;
}

// Without correlation the sum over cells is exact.
double MeanUncorrelated(const TagCells& tag, double u, double v, double su, double sv) {
  double sum = 0;
  for (int column = -8; column < tag.cells + 8; ++column) {
    for (int row = -8; row < tag.cells + 8; ++row) {
      if (!IsWhite(tag, column, row)) continue;
      sum += (NormalCdf((column + 1 - u) / su) - NormalCdf((column - u) / su)) *
             (NormalCdf((row + 1 - v) / sv) - NormalCdf((row - v) / sv));
    }
  }
  return sum;
}

struct Draw {
  double u, v, su, sv;
};
std::vector<Draw> Draws(unsigned seed, int count, int cells) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, cells), sigma(0.1, 0.8);
  std::vector<Draw> draws;
  for (int i = 0; i < count; ++i) {
    draws.push_back({place(random), place(random), sigma(random), sigma(random)});
  }
  return draws;
}

PatternValue At(const BlurredPattern& pattern, const Draw& d, double rho) {
  return pattern.At(static_cast<float>(d.u), static_cast<float>(d.v), {d.su, d.sv, rho});
}

TEST(BlurredPattern, IsTheMeanOfTheCells) {
  for (const char* family : {"tag36h11", "tagStandard41h12"}) {
    const TagCells tag = ReadTagCells(family, 5);
    const BlurredPattern pattern(tag);
    EXPECT_EQ(pattern.Cells(), tag.cells);
    for (const Draw& d : Draws(1, 2000, tag.cells)) {
      // Beyond 3.5 sigma lie 4.65e-4 of the distribution of each axis.
      EXPECT_NEAR(At(pattern, d, 0).c, MeanUncorrelated(tag, d.u, d.v, d.su, d.sv), 9.3e-4)
          << d.u << " " << d.v << " " << d.su << " " << d.sv;
    }
  }
}

TEST(BlurredPattern, KnowsTheCorrelation) {
  const TagCells tag = ReadTagCells("tag36h11", 5);
  const BlurredPattern pattern(tag);
  for (const double rho : {-0.6, -0.4, 0.2, 0.4, 0.6}) {
    double worst = 0, without = 0;
    for (const Draw& d : Draws(2, 60, tag.cells)) {
      const double mean = Mean(tag, d.u, d.v, d.su, d.sv, rho);
      worst = std::max(worst, std::abs(At(pattern, d, rho).c - mean));
      without = std::max(without, std::abs(At(pattern, d, 0).c - mean));
    }
    EXPECT_LT(worst, std::abs(rho) > 0.45 ? 0.006 : 0.0015) << rho;
    EXPECT_GT(without, 5 * worst) << rho;  // so much does it do
  }
}

// In a picture of a tag seen aslant and near, the mean over a Gaussian around a pixel, by the
// midpoint rule on a fine grid of rays.
double MeanInPicture(const TagCells& tag, const Eigen::Matrix3d& to_tag, const Eigen::Vector2d& m,
                     const Eigen::Matrix2d& spread_m) {
  constexpr int kSteps = 300;
  constexpr double kTail = 4.5;
  const Eigen::Matrix2d root = Llt(spread_m).L();
  double sum = 0, total = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector2d x =
          kTail * (Eigen::Vector2d(2 * i + 1, 2 * j + 1) / kSteps - Eigen::Vector2d::Ones());
      const Eigen::Vector2d uv = (to_tag * (m + root * x).homogeneous()).hnormalized();
      const double weight = std::exp(-0.5 * x.squaredNorm());
      total += weight;
      const auto cell = [](double at) { return static_cast<int>(std::floor(at)); };
      if (IsWhite(tag, cell(uv[0]), cell(uv[1]))) sum += weight;
    }
  }
  return sum / total;
}

TEST(BlurredPattern, KnowsThePerspective) {
  const TagCells tag = ReadTagCells("tag36h11", 5);
  const BlurredPattern pattern(tag);
  const double half = 0.5 * tag.cells, cell_m = 0.0006, depth_m = 0.025;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(1, tag.cells - 1), sigma(0.1, 0.14), one(-1, 1);
  double squared = 0, without = 0;
  constexpr int kDraws = 100;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double turn = 0.9 * one(random), across = draw % 2;  // about one axis of the tag
    Eigen::Matrix3d from_tag;
    const Eigen::Matrix3d R = ExpRotation(turn * Eigen::Vector3d(across, 1 - across, 0));
    const Eigen::Vector3d middle = depth_m * Eigen::Vector3d(0.1, -0.05, 1);
    from_tag << cell_m * R.col(0), cell_m * R.col(1),
        middle - half * cell_m * (R.col(0) + R.col(1));
    const Eigen::Matrix3d to_tag = from_tag.inverse();
    const double sigma_m = sigma(random) * cell_m / depth_m;
    const Eigen::Matrix2d spread_m = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    Eigen::Vector2d uv = DrawVector<2>(place, random);
    const int along = draw % 2;  // a line and away from crossings
    uv[along] = std::floor(uv[along]) + 0.5;
    uv[1 - along] = std::round(uv[1 - along]) + 0.2 * one(random);
    const Eigen::Vector3d ray = from_tag * uv.homogeneous();
    const double exact = MeanInPicture(tag, to_tag, ray.hnormalized(), spread_m);
    const PatternBlur blur = BlurOnTag(to_tag, spread_m, half, depth_m);
    const Eigen::Vector2f at = uv.cast<float>();
    const auto nearness = static_cast<float>(depth_m / ray.z());
    squared += std::pow(pattern.At(at[0], at[1], blur, nearness).c - exact, 2) / kDraws;
    PatternBlur flat = blur;
    flat.rate_u = flat.rate_v = 0;
    without += std::pow(pattern.At(at[0], at[1], flat).c - exact, 2) / kDraws;
  }
  EXPECT_LT(std::sqrt(squared), 0.002);
  EXPECT_GT(std::sqrt(without), 0.002);  // so much does it do
}

// Times sigma (squared), so that all are of order 1; the tails leave 0.001 (0.003).
TEST(BlurredPattern, DerivativesAreThoseOfTheMean) {
  const TagCells tag = ReadTagCells("tag36h11", 9);
  const BlurredPattern pattern(tag);
  for (const Draw& d : Draws(3, 120, tag.cells)) {
    const auto mean = [&](const Eigen::VectorXd& x) {
      return Eigen::VectorXd::Constant(1, MeanUncorrelated(tag, x[0], x[1], d.su, d.sv));
    };
    const auto gradient = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      return NumericJacobian(mean, x, 0.005).transpose();
    };
    const Eigen::Vector2d at(d.u, d.v), s(d.su, d.sv);
    const Eigen::Vector2d g = gradient(at).cwiseProduct(s);
    const Eigen::Matrix2d H =
        s.asDiagonal() * NumericJacobian(gradient, at, 0.005) * s.asDiagonal();
    const PatternValue p = At(pattern, d, 0);
    EXPECT_NEAR(p.c_u * d.su, g[0], 2e-3);
    EXPECT_NEAR(p.c_v * d.sv, g[1], 2e-3);
    EXPECT_NEAR(p.c_uu * d.su * d.su, H(0, 0), 6e-3);
    EXPECT_NEAR(p.c_uv * d.su * d.sv, H(0, 1), 2e-3);
    EXPECT_NEAR(p.c_vv * d.sv * d.sv, H(1, 1), 6e-3);
    EXPECT_TRUE(!p.flat || g.norm() + H.norm() < 0.02);
  }
}

TEST(BlurredPattern, WhereItIsKnown) {
  for (const char* family : {"tag36h11", "tagCircle21h7"}) {
    const TagCells tag = ReadTagCells(family, 0);
    const BlurredPattern pattern(tag);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-2, tag.cells + 2), reach(0.05, 1.5);
    int known = 0;
    for (int i = 0; i < 2000; ++i) {
      const double u = place(random), v = place(random), ru = reach(random), rv = reach(random);
      bool all = true;
      for (int a = -40; a <= 40 && all; ++a) {
        for (int b = -40; b <= 40 && all; ++b) {
          all = tag.At(static_cast<int>(std::floor(u + ru * a / 40)),
                       static_cast<int>(std::floor(v + rv * b / 40))) != TagCells::kUnknown;
        }
      }
      const bool says = pattern.Known(static_cast<float>(u), static_cast<float>(v),
                                      static_cast<float>(ru), static_cast<float>(rv));
      EXPECT_EQ(says, all) << u << " " << v << " " << ru << " " << rv;
      known += says;
    }
    EXPECT_GT(known, 200) << family;
  }
}

// Far from the tag and with a wide blur: values between black and white, no reading beside it.
TEST(BlurredPattern, StaysWithinBoundsFarAway) {
  const TagCells tag = ReadTagCells("tag36h11", 0);
  const BlurredPattern pattern(tag);
  for (const float u : {-1e4f, -20.0f, -5.0f, 4.0f, 18.0f, 1e4f}) {
    for (const float v : {-1e4f, -9.0f, 3.5f, 25.0f, 1e4f}) {
      for (const double sigma : {0.1, 1.6}) {
        const PatternValue p = pattern.At(u, v, {sigma, sigma, 0.7});
        EXPECT_GE(p.c, -0.01f);
        EXPECT_LE(p.c, 1.01f);
      }
    }
  }
}

// By one line of each axis, by two, and by more.
TEST(BlurredPattern, EightAtATimeIsTheSame) {
  const BlurredPattern pattern(ReadTagCells("tag36h11", 3));
  std::mt19937 random(17);
  std::uniform_real_distribution<float> place(-3, 13), sigma(0.05f, 0.45f),
      correlation(-0.5f, 0.5f);
  for (int i = 0; i < 500; ++i) {
    const float sigma_u = sigma(random), sigma_v = sigma(random), rho = correlation(random);
    PatternBlur blur(sigma_u, sigma_v, rho);
    blur.rate_u = 0.004f;
    blur.rate_v = -0.003f;
    blur.middle = 5;
    lanes::F u, v, nearness;
    for (int k = 0; k < lanes::kLanes; ++k) {
      u[k] = place(random), v[k] = place(random),
      nearness[k] = 1.0f + 0.01f * static_cast<float>(k);
    }
    lanes::Pattern p;
    lanes::LookUp(u, v, nearness, blur, pattern, p);
    for (int k = 0; k < lanes::kLanes; ++k) {
      const PatternValue one = pattern.At(u[k], v[k], blur, nearness[k]);
      const float su = blur.inverse_u, sv = blur.inverse_v;
      EXPECT_NEAR(p.c[k], one.c, 1e-4);
      EXPECT_NEAR(p.c_u[k], one.c_u, 5e-4 * su);
      EXPECT_NEAR(p.c_v[k], one.c_v, 5e-4 * sv);
      EXPECT_NEAR(p.c_uu[k], one.c_uu, 2e-3 * su * su);
      EXPECT_NEAR(p.c_uv[k], one.c_uv, 2e-3 * su * sv);
      EXPECT_NEAR(p.c_vv[k], one.c_vv, 2e-3 * sv * sv);
    }
  }
}

}  // namespace
}  // namespace flextip
