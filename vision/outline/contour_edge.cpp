#include "vision/outline/contour_edge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip {
namespace {

constexpr double kPhaseStep_px = 0.125;
constexpr double kPixelVariance_px2 = 1.0 / 12 + 1.0 / 6;  // its own width, and interpolation's
constexpr int kFlatOutside = 3;

double Phi(double z) { return 0.5 * std::erfc(-z * std::numbers::sqrt2 / 2); }

// The root of the depth inside, blurred: integral of sqrt(u) N(d + u; blur) over u > 0.
double BlurredRoot(double d, double blur) {
  constexpr int kSteps = 60;
  const double low = std::max(0.0, -d - 4 * blur), high = -d + 4 * blur;
  if (high <= low) return 0;
  double sum = 0;  // over v = sqrt(u): du sqrt(u) = 2 v^2 dv
  const double v0 = std::sqrt(low), dv = (std::sqrt(high) - v0) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double v = v0 + (i + 0.5) * dv, z = (d + v * v) / blur;
    sum += 2 * v * v * std::exp(-0.5 * z * z) * dv;
  }
  return sum / (blur * std::sqrt(2 * std::numbers::pi));
}

template <class M>
M Orthonormal(M A) {
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    for (int twice = 0; twice < 2; ++twice) {
      for (Eigen::Index k = 0; k < j; ++k) A.col(j) -= A.col(k).dot(A.col(j)) * A.col(k);
    }
    const auto norm = A.col(j).norm();
    if (norm > 1e-5f) {
      A.col(j) /= norm;
    } else {
      A.col(j).setZero();
    }
  }
  return A;
}

template <class M, class V>
float Left(const M& basis, const V& y) {
  return std::max(0.0f, y.squaredNorm() - (basis.transpose() * y).squaredNorm());
}

float LogRatio(float smooth, float step) {
  constexpr float kFloor = 2e-5f;  // squared light that residuals do not fall below (8-bit steps)
  return std::log((smooth + kFloor) / (step + kFloor));
}

}  // namespace

ScanEdgeFinder::ScanEdgeFinder(double gamma, double blur_px)
    : blur_px_(std::sqrt(blur_px * blur_px + kPixelVariance_px2)) {
  for (int i = 0; i < 256; ++i) light_[i] = static_cast<float>(std::pow(i / 255.0, gamma));
  for (int inside = kLeastInside; inside <= kInside; ++inside) {
    round_[inside - kLeastInside] = MakeModel(TubeRim::kRound, inside, kOutside);
  }
  flat_ = MakeModel(TubeRim::kFlat, kInside, kFlatOutside);
}

// Makes columns that span the possible pictures of a step at each phase. Rows out of the window are
// zero, as the samples there will be.
ScanEdgeFinder::Model ScanEdgeFinder::MakeModel(TubeRim rim, int inside, int outside) const {
  Model model;
  model.first = kInside - inside;
  model.last = kInside + outside;
  Basis smooth = Basis::Zero();
  for (int i = model.first; i <= model.last; ++i) {
    const float x = (static_cast<float>(i) - kInside) / kInside;
    smooth.row(i) << 1, x, x * x, x * x * x;
  }
  model.smooth = Orthonormal(smooth);
  for (int k = 0; k < kPhases; ++k) {
    Eigen::Matrix<double, kSamples, kTerms> A = Eigen::Matrix<double, kSamples, kTerms>::Zero();
    for (int i = model.first; i <= model.last; ++i) {
      const double d = i - kInside - (k - kMiddle) * kPhaseStep_px, z = d / blur_px_;
      const double behind = Phi(z);
      const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
      const double ramp = d * behind + blur_px_ * density;
      A.row(i) << behind, ramp, 1 - behind,
          rim == TubeRim::kRound ? BlurredRoot(d, blur_px_) : d - ramp;
    }
    model.step[k] = Orthonormal(A).cast<float>();
  }
  return model;
}

const ScanEdgeFinder::Model& ScanEdgeFinder::ModelFor(TubeRim rim, double radius_px) const {
  if (rim == TubeRim::kFlat) return flat_;
  return round_[std::clamp(static_cast<int>(0.5 * radius_px), kLeastInside, kInside) -
                kLeastInside];
}

ScanEdgeFinder::Window ScanEdgeFinder::Model::Cut(const float* light) const {
  Window y = Eigen::Map<const Window>(light);
  for (int i = 0; i < first; ++i) y[i] = 0;
  for (int i = last + 1; i < kSamples; ++i) y[i] = 0;
  return y;
}

bool ScanEdgeFinder::Sample(const Image& grey, const Eigen::Vector2d& px,
                            const Eigen::Vector2d& outward, int half_px, int aside,
                            std::vector<float>& light) const {
  const Eigen::Vector2d along(-outward.y(), outward.x());
  const double reach_x = std::abs(outward.x()) * half_px + std::abs(along.x()) * aside;
  const double reach_y = std::abs(outward.y()) * half_px + std::abs(along.y()) * aside;
  if (px.x() - reach_x < 0 || px.x() + reach_x >= grey.width_px - 1 || px.y() - reach_y < 0 ||
      px.y() + reach_y >= grey.height_px - 1) {
    return false;
  }
  light.assign(2 * half_px + 1, 0.0f);
  const auto weight = static_cast<float>(1.0 / (2 * aside + 1));
  for (int a = -aside; a <= aside; ++a) {
    Eigen::Vector2d at = px + a * along - half_px * outward;
    for (float& sum : light) {
      const auto x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
      const auto fx = static_cast<float>(at.x() - x), fy = static_cast<float>(at.y() - y);
      const std::uint8_t* p = grey.Row(y) + x;
      const std::uint8_t* q = p + grey.width_px;
      const float top = light_[p[0]] + fx * (light_[p[1]] - light_[p[0]]);
      const float low = light_[q[0]] + fx * (light_[q[1]] - light_[q[0]]);
      sum += weight * (top + fy * (low - top));
      at += outward;
    }
  }
  return true;
}

void ScanEdgeFinder::Evidence(const std::vector<float>& light, TubeRim rim, double radius_px,
                              std::vector<float>& evidence) const {
  const int half = static_cast<int>(light.size()) / 2, search = half - kMargin;
  const Model& model = ModelFor(rim, radius_px);
  evidence.resize(2 * search + 1);
  for (int d = -search; d <= search; ++d) {
    const Window y = model.Cut(light.data() + half + d - kInside);
    evidence[d + search] = LogRatio(Left(model.smooth, y), Left(model.step[kMiddle], y));
  }
}

std::optional<ScanEdge> ScanEdgeFinder::Refine(const std::vector<float>& light, TubeRim rim,
                                               double radius_px, int at) const {
  const int half = static_cast<int>(light.size()) / 2;
  if (std::abs(at) + kInside > half) return {};
  const Model& model = ModelFor(rim, radius_px);
  const Window y = model.Cut(light.data() + half + at - kInside);
  std::array<float, kPhases> left;
  int best = 0;
  for (int k = 0; k < kPhases; ++k) {
    left[k] = Left(model.step[k], y);
    if (left[k] < left[best]) best = k;
  }
  if (best == 0 || best == kPhases - 1) return {};
  const double below = left[best - 1], here = left[best], above = left[best + 1];
  const double second = below - 2 * here + above;
  if (!(second > 0)) return {};
  ScanEdge edge;
  edge.offset_px = at + (best - kMiddle + 0.5 * (below - above) / second) * kPhaseStep_px;
  edge.per_noise_px2 = 2 * kPhaseStep_px * kPhaseStep_px / second;
  constexpr int kUnknowns = kTerms + 1;
  edge.noise = here / (model.last - model.first + 1 - kUnknowns);
  edge.evidence = LogRatio(Left(model.smooth, y), left[best]);
  return edge;
}

}  // namespace flextip
