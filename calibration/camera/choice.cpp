#include "calibration/camera/choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/camera/bundle.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

// Far below what tells lenses apart.
constexpr double kTolerance = 1e-6;

// The mean of `more - less` over its standard error; views count alike.
double DifferenceInErrors(const HeldOutError& more, const HeldOutError& less) {
  const std::size_t n = std::min(more.squared_px2.size(), less.squared_px2.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = more.squared_px2[i] - less.squared_px2[i];
    sum += d;
    squares += d * d;
  }
  const double count = static_cast<double>(n), mean = sum / count;
  const double variance = std::max(0.0, squares / count - mean * mean) / std::max(1.0, count - 1);
  return variance > 0 ? mean / std::sqrt(variance) : (mean > 0 ? HUGE_VAL : 0.0);
}

// Sum of squared distances of the view's corners after its own pose was fitted.
std::optional<double> SquaresOfView(const CameraSolution& lens, const SolvedView& view) {
  CameraSolution alone;
  alone.camera = lens.camera;
  alone.warp = lens.warp;
  alone.shape = lens.shape;
  alone.views = {view};
  if (!AdjustBundle(alone, {.fix_intrinsics = true, .tolerance = kTolerance})) return {};
  return std::pow(alone.RmsPx(), 2) * alone.CornersUsed();
}

std::string Verdict(std::size_t i, std::size_t chosen, std::size_t best,
                    const LensCandidate& candidate, double worse_by) {
  if (i == chosen && i == best) return "the least held-out error";
  if (i == chosen) return "no worse than the best on held-out views, and simpler";
  if (i != best && worse_by >= 1.0) {
    return fmt::format("worse on held-out views by {:.1f} standard errors",
                       std::min(worse_by, 99.0));
  }
  if (!candidate.folds.empty()) return candidate.folds;
  return "no better on held-out views than a simpler one";
}

}  // namespace

LensModel LensModelOf(const CameraCalibration& camera) {
  return {camera.distortion, static_cast<int>(camera.distortion_coefficients.size())};
}

std::string LensModel::Name() const {
  switch (distortion) {
    case Distortion::kRadialTangential:
      return "radial-tangential";
    case Distortion::kEquidistant:
      return "equidistant";
    case Distortion::kOpenCv:
      break;
  }
  return fmt::format("opencv {}", terms);
}

const std::vector<LensModel>& AllLensModels() {
  static const std::vector<LensModel> models = {{Distortion::kRadialTangential, 4},
                                                {Distortion::kEquidistant, 4},
                                                {Distortion::kOpenCv, 5},
                                                {Distortion::kOpenCv, 8},
                                                {Distortion::kOpenCv, 12}};
  return models;
}

std::optional<HeldOutError> LeaveViewsOut(const CameraSolution& solution, int folds) {
  HeldOutError error;
  error.squared_px2.assign(solution.views.size(), 0.0);
  double squares = 0.0, count = 0.0;
  for (int fold = 0; fold < folds; ++fold) {
    CameraSolution rest = solution;
    rest.views.clear();
    std::vector<std::size_t> left_out;
    for (std::size_t v = 0; v < solution.views.size(); ++v) {
      if (static_cast<int>(v) % folds == fold) {
        left_out.push_back(v);
      } else {
        rest.views.push_back(solution.views[v]);
      }
    }
    const BundleOptions options{.estimate_warp = solution.warp_estimated,
                                .estimate_shape = solution.shape.sd_m > 0,
                                .tolerance = kTolerance};
    if (!AdjustBundle(rest, options)) return {};
    for (const std::size_t v : left_out) {
      const auto sum = SquaresOfView(rest, solution.views[v]);
      if (!sum) return {};
      const double free = std::max(1.0, solution.views[v].CountUsed() - 3.0);  // 6 / 2 for the pose
      error.squared_px2[v] = *sum / free;
      squares += *sum;
      count += free;
    }
  }
  error.rms_px = std::sqrt(squares / count);
  return error;
}

std::optional<std::size_t> ChooseLens(std::vector<LensCandidate>& candidates) {
  std::optional<std::size_t> best, chosen, whole;
  const auto usable = [&](std::size_t i) {
    return candidates[i].heldout && candidates[i].reason.empty();
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (usable(i) && (!best || candidates[i].heldout->rms_px < candidates[*best].heldout->rms_px)) {
      best = i;
    }
  }
  if (!best) return {};
  const auto worse_by = [&](std::size_t i) {
    return DifferenceInErrors(*candidates[i].heldout, *candidates[*best].heldout);
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!usable(i) || (i != *best && worse_by(i) >= 1.0)) continue;
    if (!chosen) chosen = i;
    if (!whole && candidates[i].folds.empty()) whole = i;
  }
  chosen = whole ? whole : chosen;
  candidates[*chosen].chosen = true;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (usable(i)) candidates[i].reason = Verdict(i, *chosen, *best, candidates[i], worse_by(i));
  }
  return chosen;
}

bool WarpHelps(const HeldOutError& flat, const HeldOutError& warped) {
  return DifferenceInErrors(flat, warped) > 1.0;
}

bool ShapeHelps(const HeldOutError& as_described, const HeldOutError& shaped) {
  return DifferenceInErrors(as_described, shaped) > 2.0;
}

std::string FoldsInPicture(const CameraCalibration& camera) {
  const CameraModel model(camera);
  const double right = camera.width_px - 1.0, bottom = camera.height_px - 1.0;
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(0, 0), Eigen::Vector2d(right, 0),
                                    Eigen::Vector2d(0, bottom), Eigen::Vector2d(right, bottom)}) {
    if (model.Unproject(px)) continue;
    return fmt::format("its distortion turns back on itself before pixel ({:.0f}, {:.0f})", px.x(),
                       px.y());
  }
  return {};
}

}  // namespace flextip
