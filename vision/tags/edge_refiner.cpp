#include "vision/tags/edge_refiner.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "core/levenberg_marquardt.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

constexpr double kMinBand_px = 1.2, kMaxBand_px = 3.5;
constexpr double kBandOfCell = 0.6;  // the next cell's edge is at 1.0 and blurred
constexpr double kMaxRimBand_px = 4.5, kRimBandOfCell = 0.85;  // outward, where a rim is looked for
constexpr double kRimDrop = 0.12;      // of the contrast: by so much a rim's far side must differ
constexpr double kMinContrast = 12.0;  // grey levels
constexpr double kMinBlur_px = 0.25, kMaxBlur_px = 3.0;
constexpr int kMinPixels = 14;

// An edge's own axes: s along it from its middle, d across it, away from the tag.
struct EdgeFrame {
  Eigen::Vector2d middle, along, out;
  double half_length_px = 0.0;
  double cell_px[2] = {0.0, 0.0};  // cell depth across the edge at its two ends
};

struct EdgePixel {
  double s, d, grey;
};

// d = offset + slope s is the fitted line.
struct EdgeLine {
  double offset_px = 0.0, slope = 0.0;
  bool fitted = false;
};

EdgeFrame MakeFrame(const std::array<Eigen::Vector2d, 4>& corners, int edge, int cells_across) {
  const Eigen::Vector2d& a = corners[edge];
  const Eigen::Vector2d& b = corners[(edge + 1) % 4];
  EdgeFrame f;
  f.middle = 0.5 * (a + b);
  f.half_length_px = 0.5 * (b - a).norm();
  f.along = (b - a) / (2 * f.half_length_px);
  f.out = Eigen::Vector2d(f.along.y(), -f.along.x());
  const Eigen::Vector2d& beyond_a = corners[(edge + 3) % 4];
  const Eigen::Vector2d& beyond_b = corners[(edge + 2) % 4];
  if (f.out.dot(0.5 * (beyond_a + beyond_b) - f.middle) > 0) f.out = -f.out;
  f.cell_px[0] = -f.out.dot(beyond_a - a) / cells_across;
  f.cell_px[1] = -f.out.dot(beyond_b - b) / cells_across;
  return f;
}

// The pixels beside the edge, nearer than the next cell and away from the corners' rounding.
// Outward the band is wider where the tag's white rim may end (`look_for_rim`).
std::vector<EdgePixel> CollectPixels(const Image& grey, const EdgeFrame& f, const EdgeLine& line,
                                     bool look_for_rim) {
  const double length = 2 * f.half_length_px;
  const double cell = 0.5 * (f.cell_px[0] + f.cell_px[1]);
  const double end = std::min(std::max(2.0, 0.6 * cell), 0.3 * length);
  const double s_max = f.half_length_px - end;
  const double reach =
      kMaxRimBand_px + std::abs(line.offset_px) + std::abs(line.slope) * f.half_length_px + 1.0;
  const Eigen::Vector2d extent = f.along.cwiseAbs() * f.half_length_px + f.out.cwiseAbs() * reach;
  const int x0 = std::max(0, static_cast<int>(std::ceil(f.middle.x() - extent.x())));
  const int x1 = std::min(grey.width_px - 1, static_cast<int>(f.middle.x() + extent.x()));
  const int y0 = std::max(0, static_cast<int>(std::ceil(f.middle.y() - extent.y())));
  const int y1 = std::min(grey.height_px - 1, static_cast<int>(f.middle.y() + extent.y()));
  std::vector<EdgePixel> pixels;
  for (int y = y0; y <= y1; ++y) {
    const std::uint8_t* row = grey.Row(y);
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d offset = Eigen::Vector2d(x, y) - f.middle;
      const double s = f.along.dot(offset), d = f.out.dot(offset);
      if (std::abs(s) > s_max) continue;
      const double at = 0.5 * (1 + s / f.half_length_px);
      const double local_cell = f.cell_px[0] + at * (f.cell_px[1] - f.cell_px[0]);
      const double inside = std::clamp(kBandOfCell * local_cell, kMinBand_px, kMaxBand_px);
      const double outside =
          look_for_rim ? std::clamp(kRimBandOfCell * local_cell, kMinBand_px, kMaxRimBand_px)
                       : inside;
      const double across = d - line.offset_px - line.slope * s;
      if (across < -inside || across > outside) continue;
      pixels.push_back({s, d, static_cast<double>(row[x])});
    }
  }
  return pixels;
}

// grey = lo + (hi - lo) Phi(z) + (beyond - hi) Phi(z2), z = (d - offset - slope s) / blur and
// z2 = z - rim / blur, lo = q3 + q4 s, hi = q5 + q6 s.
// q = offset, slope, blur, q3..q6, rim, beyond: dark inside the tag, its white rim, and what lies
// beyond the rim; rim 0 stands for none within reach. Returns the residual and its derivative.
double Residual(const EdgePixel& p, const Vector9& q, Vector9* J) {
  const auto phi = [](double z) { return std::exp(-0.5 * z * z) / std::sqrt(2 * M_PI); };
  const bool rim = q[7] > 0;
  const double z = (p.d - q[0] - q[1] * p.s) / q[2], z2 = z - q[7] / q[2];
  const double step = 0.5 * std::erfc(-z * M_SQRT1_2);
  const double step2 = rim ? 0.5 * std::erfc(-z2 * M_SQRT1_2) : 0.0;
  const double lo = q[3] + q[4] * p.s, hi = q[5] + q[6] * p.s;
  if (J) {
    const double g = -(hi - lo) * phi(z) / q[2];
    const double g2 = rim ? -(q[8] - hi) * phi(z2) / q[2] : 0.0;
    *J << g + g2, (g + g2) * p.s, g * z + g2 * z2, 1 - step, (1 - step) * p.s, step - step2,
        (step - step2) * p.s, g2, step2;
  }
  return lo + (hi - lo) * step + (q[8] - hi) * step2 - p.grey;
}

// Mean levels on both sides of the line to start from.
Vector9 StartValues(const std::vector<EdgePixel>& pixels, const EdgeLine& line) {
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (const EdgePixel& p : pixels) {
    const double d = p.d - line.offset_px - line.slope * p.s;
    if (std::abs(d) < 0.7) continue;
    sum[d > 0] += p.grey;
    ++count[d > 0];
  }
  Vector9 q;
  q << line.offset_px, line.slope, 0.8, sum[0] / std::max(1, count[0]), 0,
      sum[1] / std::max(1, count[1]), 0, 0, 0;
  return q;
}

// The mean grey value over half-pixel steps of the distance from the line. Whether the values
// outside first rise to a rim's and then differ again; `q` then starts with that rim.
bool FindRim(const std::vector<EdgePixel>& pixels, const EdgeLine& line, Vector9& q) {
  constexpr int kBins = 10;
  double sum[kBins] = {}, count[kBins] = {};
  for (const EdgePixel& p : pixels) {
    const double d = p.d - line.offset_px - line.slope * p.s;
    const int bin = static_cast<int>(std::floor(2 * d));
    if (bin < 0 || bin >= kBins) continue;
    sum[bin] += p.grey;
    count[bin] += 1;
  }
  const double sign = q[5] > q[3] ? 1 : -1;
  const auto height = [&](int bin) { return sign * (sum[bin] / count[bin] - q[3]); };
  int bins = 0;
  while (bins < kBins && count[bins] >= 4) ++bins;
  int peak = 0;
  for (int i = 1; i < bins; ++i) peak = height(i) > height(peak) ? i : peak;
  if (bins < 3 || peak + 1 >= bins) return false;
  int low = peak + 1;
  for (int i = low; i < bins; ++i) low = height(i) < height(low) ? i : low;
  if (height(peak) - height(low) < kRimDrop * height(peak)) return false;
  const double middle = 0.5 * (height(peak) + height(low));
  int crossing = peak;
  while (crossing < low && height(crossing + 1) > middle) ++crossing;
  q[7] = 0.5 * (crossing + 1);
  q[5] = q[3] + sign * height(peak);
  q[8] = q[3] + sign * height(low);
  return true;
}

// Twice the median absolute residual, the distance from which a pixel counts less (an occluder, a
// highlight).
double RobustScale(const std::vector<EdgePixel>& pixels, const Vector9& q) {
  std::vector<double> size;
  size.reserve(pixels.size());
  for (const EdgePixel& p : pixels) size.push_back(std::abs(Residual(p, q, nullptr)));
  return std::max(3.0, 3.0 * Median(std::move(size)));
}

double HuberCost(const std::vector<EdgePixel>& pixels, const Vector9& q, double scale) {
  double cost = 0.0;
  for (const EdgePixel& p : pixels) {
    const double r = std::abs(Residual(p, q, nullptr));
    cost += r < scale ? r * r : scale * (2 * r - scale);
  }
  return cost;
}

// The step of the weighted normal equations at `q`, with their diagonal enlarged.
Vector9 HuberStep(const std::vector<EdgePixel>& pixels, const Vector9& q, double scale,
                  double damping) {
  Matrix9 A = Matrix9::Zero();
  Vector9 b = Vector9::Zero(), J;
  for (const EdgePixel& p : pixels) {
    const double r = Residual(p, q, &J);
    const double weight = std::abs(r) < scale ? 1.0 : scale / std::abs(r);
    A.noalias() += weight * J * J.transpose();
    b.noalias() += weight * r * J;
  }
  A.diagonal() *= 1 + damping;
  if (q[7] <= 0) A(7, 7) = A(8, 8) = 1;  // no rim
  return Ldlt(A).Solve(b);
}

// Levenberg-Marquardt with Huber weights: moves `q` and `damping` by so many steps, fewer where the
// offset moves by less than `settled_px`. Returns whether the last step helped.
bool MinimiseHuber(const std::vector<EdgePixel>& pixels, double scale, int steps, double settled_px,
                   Vector9& q, double& damping) {
  const bool rim = q[7] > 0;
  bool helped = false;
  double cost = HuberCost(pixels, q, scale), next_cost = cost;
  Vector9 next = q;
  const auto try_step = [&](double with_damping) -> TrialStep {
    const Vector9 step = HuberStep(pixels, q, scale, with_damping);
    next = q - step;
    next[2] = std::clamp(next[2], kMinBlur_px, kMaxBlur_px);
    if (rim) next[7] = std::clamp(next[7], 0.3, 2 * kMaxRimBand_px);
    next_cost = step.allFinite() ? HuberCost(pixels, next, scale) : HUGE_VAL;
    helped = next_cost <= cost;
    return {next_cost, helped && std::abs(next[0] - q[0]) < settled_px};
  };
  const auto accept = [&] {
    q = next;
    cost = next_cost;
  };
  damping = Descend(cost, std::ref(try_step), std::ref(accept),
                    {.max_iterations = steps,
                     .start_damping = damping,
                     .least_damping = 1e-7,
                     .floor = 1e-7,
                     .least_raised = 0.0,
                     .most_damping = 1e6,
                     .relative_gain = 0.0})
                .damping;
  return helped;
}

// With the residuals' scale learned again where the fit has come near.
Vector9 Minimise(const std::vector<EdgePixel>& pixels, Vector9 q) {
  constexpr int kFirstSteps = 4, kMoreSteps = 21;
  constexpr double kSettled_px = 1e-4;
  double scale = RobustScale(pixels, q), damping = 1e-3;
  const bool helped = MinimiseHuber(pixels, scale, kFirstSteps, 0.0, q, damping);
  if (helped) scale = RobustScale(pixels, q);
  MinimiseHuber(pixels, scale, kMoreSteps, kSettled_px, q, damping);
  return q;
}

// Whether the fit describes an edge of enough contrast near where it was looked for.
bool IsSane(const Vector9& q, double half_length_px, double limit_px) {
  return q.allFinite() && std::abs(q[5] - q[3]) >= kMinContrast && q[2] < kMaxBlur_px &&
         std::abs(q[0]) + std::abs(q[1]) * half_length_px < limit_px;
}

// One fit to the pixels around `line`; with the rim's far side where there is one.
std::optional<Vector9> FitAround(const Image& grey, const EdgeFrame& f, const EdgeLine& line) {
  std::vector<EdgePixel> pixels = CollectPixels(grey, f, line, true);
  if (static_cast<int>(pixels.size()) < kMinPixels) return {};
  Vector9 q = StartValues(pixels, line);
  if (!FindRim(pixels, line, q)) {
    pixels = CollectPixels(grey, f, line, false);
    if (static_cast<int>(pixels.size()) < kMinPixels) return {};
    q = StartValues(pixels, line);
  }
  return Minimise(pixels, q);
}

EdgeLine FitEdge(const Image& grey, const EdgeFrame& f) {
  const double cell = std::min(f.cell_px[0], f.cell_px[1]);
  if (!(cell > kMinBand_px) || f.half_length_px < 4.0) return {};
  EdgeLine line;
  for (int round = 0; round < 3; ++round) {  // again with the pixels of the moved line
    const auto q = FitAround(grey, f, line);
    if (!q || !IsSane(*q, f.half_length_px, std::min(1.5, 0.5 * cell))) return {};
    const bool settled = line.fitted && std::abs((*q)[0] - line.offset_px) < 0.02 &&
                         std::abs((*q)[1] - line.slope) * f.half_length_px < 0.02;
    line = {(*q)[0], (*q)[1], true};
    if (settled) break;
  }
  return line;
}

// A line as a point and a direction.
struct Line {
  Eigen::Vector2d point, direction;
};

std::optional<Eigen::Vector2d> Intersect(const Line& a, const Line& b) {
  Eigen::Matrix2d A;
  A << a.direction, -b.direction;
  if (std::abs(A.determinant()) < 0.05) return {};
  return Eigen::Vector2d(a.point + a.direction * (A.inverse() * (b.point - a.point)).x());
}

}  // namespace

RefinedQuad RefineCorners(const Image& grey, const std::array<Eigen::Vector2d, 4>& corners_px,
                          int cells_across) {
  RefinedQuad result{corners_px, 0};
  std::array<Line, 4> lines;
  for (int i = 0; i < 4; ++i) {
    const EdgeFrame f = MakeFrame(corners_px, i, cells_across);
    const EdgeLine fit = FitEdge(grey, f);
    result.edges_fitted += fit.fitted;
    lines[i] = {f.middle + fit.offset_px * f.out, (f.along + fit.slope * f.out).normalized()};
  }
  for (int i = 0; i < 4; ++i) {  // corner i lies between edges i - 1 and i
    const auto corner = Intersect(lines[(i + 3) % 4], lines[i]);
    if (!corner) return {corners_px, 0};
    result.corners_px[i] = *corner;
  }
  return result;
}

}  // namespace flextip
