#include "simulation/render/tissue_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/rotation.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

std::uint32_t Hash(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x9e3779b1u) ^
                    (static_cast<std::uint32_t>(y) * 0x85ebca77u);
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

const std::array<Eigen::Vector2d, 64>& Gradients() {
  static const std::array<Eigen::Vector2d, 64> table = [] {
    std::array<Eigen::Vector2d, 64> t;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / t.size();
      t[i] = {std::cos(angle), std::sin(angle)};
    }
    return t;
  }();
  return table;
}

// Perlin's gradient noise with the quintic fade, about -0.7 to 0.7: (value, d/du, d/dv).
Vector3d Noise(double u, double v, std::uint32_t seed) {
  const double fu = std::floor(u), fv = std::floor(v);
  const auto iu = static_cast<std::int32_t>(fu), iv = static_cast<std::int32_t>(fv);
  const double x = u - fu, y = v - fv;
  const auto& gradients = Gradients();
  const auto corner = [&](int a, int b) -> const Eigen::Vector2d& {
    return gradients[Hash(iu + a, iv + b, seed) & 63];
  };
  const Eigen::Vector2d &g00 = corner(0, 0), &g10 = corner(1, 0), &g01 = corner(0, 1),
                        &g11 = corner(1, 1);
  const double n00 = g00.x() * x + g00.y() * y, n10 = g10.x() * (x - 1) + g10.y() * y;
  const double n01 = g01.x() * x + g01.y() * (y - 1), n11 = g11.x() * (x - 1) + g11.y() * (y - 1);
  const double p = x * x * x * (x * (6 * x - 15) + 10), dp = 30 * x * x * (x - 1) * (x - 1);
  const double q = y * y * y * (y * (6 * y - 15) + 10), dq = 30 * y * y * (y - 1) * (y - 1);
  const double low = n00 + p * (n10 - n00), high = n01 + p * (n11 - n01);
  const Eigen::Vector2d g_low = g00 + p * (g10 - g00), g_high = g01 + p * (g11 - g01);
  const double du = (1 - q) * (g_low.x() + dp * (n10 - n00)) + q * (g_high.x() + dp * (n11 - n01));
  const double dv = (1 - q) * g_low.y() + q * g_high.y() + dq * (high - low);
  return {low + q * (high - low), du, dv};
}

// Octaves of noise, each twice as fine and `gain` times as strong.
Vector3d Octaves(double u, double v, int count, double gain, std::uint32_t seed) {
  Vector3d sum = Vector3d::Zero();
  double strength = 1, frequency = 1;
  for (int i = 0; i < count; ++i) {
    const Vector3d n = Noise(u * frequency, v * frequency, seed + 101u * static_cast<unsigned>(i));
    sum += strength * Vector3d(n[0], frequency * n[1], frequency * n[2]);
    strength *= gain;
    frequency *= 2.03;
  }
  return sum;
}

double SmoothStep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

TissueTexture::TissueTexture(const TissueOptions& options, const Pose& T_RC, std::uint64_t seed)
    : options_(options), seed_(static_cast<std::uint32_t>(seed * 2654435761u + 12345u)) {
  const Pose T_CR = T_RC.Inverse();
  normal_C_ = (T_CR.R * options.normal_R).normalized();
  const Eigen::Matrix<double, 3, 2> basis = NormalBasis(options.normal_R.normalized());
  point_C_ = T_CR * options.point_R;
  e_u_ = T_CR.R * basis.col(0);
  e_v_ = T_CR.R * basis.col(1);
}

Vector3d TissueTexture::Relief(double u, double v) const {
  // Hills of a few patches' size; gradient noise has a standard deviation of about 1/4.
  const double size = 2.2 * options_.texture_scale_m, height = 4.0 * options_.relief_m;
  const Vector3d n = Octaves(u / size, v / size, 2, 0.3, seed_ + 7);
  return {height * n[0], height / size * n[1], height / size * n[2]};
}

double TissueTexture::Vessels(double u, double v) const {
  // Thin lines where a warped noise crosses zero, in some places only.
  const double size = 1.6 * options_.texture_scale_m;
  const double wu = u / size + 0.25 * Noise(u / size * 2.3, v / size * 2.3, seed_ + 31)[0];
  const double wv = v / size + 0.25 * Noise(u / size * 2.3, v / size * 2.3, seed_ + 37)[0];
  double vessels = 0;
  for (int i = 0; i < 2; ++i) {
    const double finer = i == 0 ? 0.8 : 1.9;
    const Vector3d n = Noise(wu * finer, wv * finer, seed_ + 41u + static_cast<unsigned>(i));
    const double distance = std::abs(n[0]) / (0.15 + std::hypot(n[1], n[2]));
    const double width = i == 0 ? 0.035 : 0.022;
    const double here = SmoothStep(0.0, 0.35, Noise(wu * 0.6, wv * 0.6, seed_ + 53u + i)[0] + 0.1);
    vessels = std::max(vessels, (1 - SmoothStep(0.3 * width, width, distance)) * here);
  }
  return vessels;
}

Vector3f TissueTexture::Albedo(double u, double v) const {
  const double size = options_.texture_scale_m, contrast = options_.texture_contrast;
  const Vector3d mean = options_.albedo_bgr;
  if (contrast <= 0) return mean.cast<float>();
  const double patches = Octaves(u / size, v / size, 6, 0.62, seed_)[0];
  const double fat = Octaves(u / size * 0.7 + 40, v / size * 0.7, 4, 0.55, seed_ + 17)[0];
  const double clots = Octaves(u / size * 2.6, v / size * 2.6 + 9, 3, 0.5, seed_ + 23)[0];
  Vector3d colour = mean * (1 + contrast * 0.55 * patches);
  const Vector3d pale(0.36, 0.45, 0.84), dark(0.08, 0.07, 0.24), vessel(0.07, 0.05, 0.34);
  const auto blend = [&](const Vector3d& other, double part) {
    colour += std::min(contrast, 1.0) * part * (other - colour);
  };
  blend(pale, 0.55 * SmoothStep(0.10, 0.65, fat));
  blend(dark, 0.50 * SmoothStep(0.22, 0.75, clots));
  blend(vessel, 0.5 * Vessels(u, v));
  return colour.cwiseMax(0.0).cwiseMin(1.0).cast<float>();
}

Vector3f TissueTexture::Radiance(const Vector3d& ray, const render::Light& light,
                                 double& depth) const {
  depth = std::numeric_limits<double>::infinity();
  const double slope = normal_C_.dot(ray), distance = normal_C_.dot(point_C_);
  if (slope * distance <= 0) return Vector3f::Zero();
  double height = 0, u = 0, v = 0, t = 0;
  Vector3d relief = Vector3d::Zero();
  for (int i = 0; i < (options_.relief_m > 0 ? 4 : 1); ++i) {  // parallax of the hills
    t = (distance + height) / slope;
    const Vector3d x = t * ray - point_C_;
    u = e_u_.dot(x);
    v = e_v_.dot(x);
    if (options_.relief_m > 0) relief = Relief(u, v);
    height = relief[0];
  }
  if (t <= 0) return Vector3f::Zero();
  depth = t;
  const Vector3d x = t * ray;
  const Vector3d smooth = normal_C_ - relief[1] * e_u_ - relief[2] * e_v_;
  const Vector3f albedo = Albedo(u, v);
  const render::Shade shade = light.On(x, smooth.normalized(), render::Material{});
  if (options_.wetness <= 0) return albedo * shade.diffuse;
  // A film of water follows finer bumps than the colour shows; it mirrors the light at the eye.
  const double size = 0.55 * options_.texture_scale_m;
  const Vector3d bump = Octaves(u / size, v / size, 3, 0.30, seed_ + 61);
  const Vector3d wet = (smooth - 0.16 * (bump[1] * e_u_ + bump[2] * e_v_)).normalized();
  const double facing = std::abs(wet.dot(x)) / x.norm();
  const double pool =
      SmoothStep(-0.25, 0.35, Noise(u / size * 0.45, v / size * 0.45, seed_ + 71)[0]);
  const double mirror =
      options_.wetness * pool * (0.9 * std::pow(facing, 220) + 0.10 * std::pow(facing, 24));
  const auto specular = static_cast<float>(light.Irradiance(x) * mirror);
  return albedo * shade.diffuse + Vector3f(0.86f, 0.90f, 1.0f) * specular;
}

}  // namespace flextip::simulation
