#include "calibration/em/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kMargin = 1.001;  // so that the outermost places are inside
constexpr double kLeastHalfSide_m = 1e-3;
constexpr double kLeastThickness = 0.15;  // of the largest spread
constexpr int kCellsForOrder1 = 12, kCellsForMore = 16;
constexpr int kPlacesForSpline = 600;  // five for each place of the splines

int CellsVisited(const std::vector<Eigen::Vector3d>& places, const EmCoverage& coverage) {
  bool visited[27] = {};
  for (const auto& p : places) {
    const Eigen::Vector3d u = (p - coverage.centre_m).cwiseQuotient(coverage.scale_m);
    int cell = 0;
    for (int i = 0; i < 3; ++i) {
      cell = 3 * cell + std::clamp(static_cast<int>(std::floor(1.5 * (u[i] + 1.0))), 0, 2);
    }
    visited[cell] = true;
  }
  return static_cast<int>(std::count(std::begin(visited), std::end(visited), true));
}

std::string WhyNot(const EmCoverage& coverage, int cells_needed) {
  if (coverage.spread_m[0] < kLeastThickness * coverage.spread_m[2]) {
    return fmt::format(
        "the sensor stayed near a {}: its spread is {:.1f} x {:.1f} x {:.1f} mm",
        coverage.spread_m[1] < kLeastThickness * coverage.spread_m[2] ? "line" : "plane",
        1e3 * coverage.spread_m[2], 1e3 * coverage.spread_m[1], 1e3 * coverage.spread_m[0]);
  }
  if (coverage.cells >= cells_needed) return "";
  return fmt::format("the sensor visited {} of the 27 parts of its box; {} are needed",
                     coverage.cells, cells_needed);
}

}  // namespace

EmCoverage CoverageOf(const std::vector<Eigen::Vector3d>& places) {
  Eigen::Vector3d low = places.front(), high = low, mean = Eigen::Vector3d::Zero();
  for (const auto& p : places) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    mean += p / static_cast<double>(places.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& p : places) {
    scatter += (p - mean) * (p - mean).transpose() / static_cast<double>(places.size());
  }
  EmCoverage coverage;
  coverage.centre_m = 0.5 * (low + high);
  coverage.scale_m = (0.5 * kMargin * (high - low)).cwiseMax(kLeastHalfSide_m);
  coverage.spread_m = SymmetricEigenvalues(scatter).cwiseMax(0.0).cwiseSqrt();
  coverage.places = static_cast<int>(places.size());
  coverage.cells = CellsVisited(places, coverage);
  return coverage;
}

std::vector<EmCandidate> FieldCandidates(const EmCoverage& coverage) {
  const EmDesign plain{
      .free_distance = false, .centre_m = coverage.centre_m, .scale_m = coverage.scale_m};
  std::vector<EmCandidate> candidates{{.name = "no field", .design = plain}};
  for (int order = 1; order <= 3; ++order) {
    EmDesign design = plain;
    design.basis = {FieldKind::kPolynomial, order};
    candidates.push_back(
        {.name = fmt::format("order {}", order),
         .design = design,
         .reason = WhyNot(coverage, order == 1 ? kCellsForOrder1 : kCellsForMore)});
  }
  for (const double bend_sd_m : {5e-5, 2e-4, 1e-3}) {
    EmDesign design = plain;
    design.basis = {FieldKind::kSpline, 5};
    design.bend_sd_m = bend_sd_m;
    candidates.push_back(
        {.name = fmt::format("spline 5 of {:.2f} mm", 1e3 * bend_sd_m),
         .design = design,
         .reason = coverage.places < kPlacesForSpline
                       ? fmt::format("{} samples, {} are needed", coverage.places, kPlacesForSpline)
                       : WhyNot(coverage, kCellsForMore)});
  }
  return candidates;
}

}  // namespace flextip
