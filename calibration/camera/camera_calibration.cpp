#include "calibration/camera/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "calibration/camera/board_shape.h"
#include "calibration/camera/bundle.h"
#include "calibration/camera/start.h"
#include "core/error.h"

namespace flextip {
namespace {

constexpr int kMinCorners = 6;
// Standard deviations above these say that the views do not determine the camera.
constexpr double kMostFocalDeviation = 0.05;   // of the focal length
constexpr double kMostCentreDeviation = 0.10;  // of the picture's diagonal

struct Setup {
  std::vector<SolvedView> views;
  int width_px, height_px;
  BoardWarp warp;
  CameraCalibrationOptions options;
  BoardShape shape = {};  // once it is known to differ from the description
};

// One lens fitted, with the views that it rejects.
struct LensFit {
  CameraSolution solution;
  std::vector<RejectedView> rejected;
};

// Where the two families of lenses start, each found when it is first asked for.
class Starts {
 public:
  explicit Starts(const Setup& setup) : setup_(setup) {}
  const std::optional<CameraSolution>& Of(bool equidistant) {
    auto& start = equidistant ? equidistant_ : opencv_;
    if (!start) {
      start = StartSolution(setup_.views, setup_.width_px, setup_.height_px, equidistant);
    }
    return *start;
  }

 private:
  const Setup& setup_;
  std::optional<std::optional<CameraSolution>> opencv_, equidistant_;
};

void CheckOptions(int width_px, int height_px, const CameraCalibrationOptions& o) {
  if (width_px <= 0 || height_px <= 0) {
    throw InputError(
        fmt::format("camera: expected a size in pixels, found {}x{}", width_px, height_px));
  }
  if (!o.lens) return;
  const auto& all = AllLensModels();
  const bool known = std::any_of(all.begin(), all.end(), [&](const LensModel& m) {
    return m.distortion == o.lens->distortion && m.terms == o.lens->terms;
  });
  if (!known) {
    throw InputError(fmt::format("camera: no lens model with {} terms", o.lens->terms));
  }
}

BoardWarp FlatBoard(const BoardSpec& board) {
  const auto [low, high] = BoardExtent(board);
  BoardWarp warp;
  warp.centre_m = 0.5 * (low + high);
  warp.half_m = 0.5 * (high - low);
  return warp;
}

std::vector<SolvedView> UsableViews(const std::vector<BoardView>& views,
                                    CameraCalibrationResult& result) {
  std::vector<SolvedView> usable;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BoardSighting& seen = views[v].sighting;
    CalibrationView view{.name = views[v].name, .used = false, .reason = seen.reason};
    if (seen.Found() && static_cast<int>(seen.px.size()) < kMinCorners) {
      view.reason = fmt::format("{} corners, at least {} are needed", seen.px.size(), kMinCorners);
    } else if (seen.Found()) {
      SolvedView solved;
      solved.name = views[v].name;
      solved.index = v;
      solved.ids = seen.ids;
      solved.x_B = seen.x_B;
      solved.px = seen.px;
      solved.reason.resize(seen.px.size());
      usable.push_back(solved);
      view.used = true;
    }
    result.views.push_back(view);
  }
  return usable;
}

bool MayWarp(const Setup& setup) { return setup.options.warp.value_or(true); }

// A solution with another lens model of the same family: terms are added as zeros or left out.
CameraSolution WithLens(CameraSolution s, const LensModel& lens) {
  s.camera.distortion = lens.distortion;
  s.camera.distortion_coefficients.resize(static_cast<std::size_t>(lens.terms), 0.0);
  return s;
}

// The lens with its own outliers.
std::optional<LensFit> FitLens(const Setup& setup, const LensModel& lens, bool warp,
                               Starts& starts) {
  const auto& start = starts.Of(lens.distortion == Distortion::kEquidistant);
  if (!start) return {};
  LensFit fit{WithLens(*start, lens), {}};
  fit.solution.warp = setup.warp;
  fit.solution.shape = setup.shape;
  OutlierRule rule = setup.options.outliers;
  rule.estimate_warp = warp;
  if (!RejectOutliers(fit.solution, rule, fit.rejected)) return {};
  return fit;
}

// The corners (view, place) that a solution uses.
std::set<std::pair<std::size_t, std::size_t>> CornersOf(const CameraSolution& s) {
  std::set<std::pair<std::size_t, std::size_t>> used;
  for (const SolvedView& view : s.views) {
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      if (view.IsUsed(i)) used.emplace(view.index, i);
    }
  }
  return used;
}

// Models are compared over the same corners, those that any of them explains: one that does not fit
// must not look better for having called the rest outliers.
std::optional<CameraSolution> OverCorners(
    const CameraSolution& solution, const std::vector<SolvedView>& views,
    const std::set<std::pair<std::size_t, std::size_t>>& corners) {
  CameraSolution s = solution;
  s.views.clear();
  for (SolvedView view : views) {
    const auto known = std::find_if(solution.views.begin(), solution.views.end(),
                                    [&](const auto& v) { return v.index == view.index; });
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      view.reason[i] = corners.count({view.index, i}) ? "" : "no lens model explains it";
    }
    if (view.CountUsed() < kMinCorners) continue;
    if (known == solution.views.end()) return {};
    view.T_CB = known->T_CB;
    s.views.push_back(view);
  }
  if (!AdjustBundle(s, {.estimate_warp = solution.warp_estimated})) return {};
  return s;
}

// All lens models that can be fitted, with their held-out errors over the same corners.
std::vector<LensCandidate> TryLenses(const Setup& setup, Starts& starts) {
  std::vector<LensCandidate> candidates;
  std::set<std::pair<std::size_t, std::size_t>> explained;
  for (const LensModel& lens : AllLensModels()) {
    LensCandidate candidate{
        .model = lens, .solution = {}, .heldout = {}, .folds = {}, .reason = {}};
    if (auto fit = FitLens(setup, lens, MayWarp(setup), starts)) {
      candidate.solution = fit->solution;
      explained.merge(CornersOf(fit->solution));
    } else {
      candidate.reason = "could not be fitted";
    }
    candidates.push_back(std::move(candidate));
  }
  for (LensCandidate& c : candidates) {
    if (!c.reason.empty()) continue;
    const auto common = OverCorners(c.solution, setup.views, explained);
    if (common) c.heldout = LeaveViewsOut(*common, setup.options.folds);
    if (!c.heldout) {
      c.reason = "could not be fitted to what other models explain";
      continue;
    }
    c.solution = *common;
    c.folds = FoldsInPicture(c.solution.camera);
  }
  return candidates;
}

// Whether the board is to be taken for bent, judged on views left out.
bool DecideWarp(const Setup& setup, const CameraSolution& warped, std::string& reason) {
  if (setup.options.warp) {
    reason = "as asked for";
    return *setup.options.warp;
  }
  CameraSolution flat = warped;
  flat.warp.bulge_m.setZero();
  const auto with = LeaveViewsOut(warped, setup.options.folds);
  const auto without = AdjustBundle(flat) ? LeaveViewsOut(flat, setup.options.folds) : std::nullopt;
  const bool helps = with && (!without || WarpHelps(*without, *with));
  reason = helps ? "held-out views are predicted better with a bent board"
                 : "held-out views are predicted no better with a bent board";
  return helps;
}

// The lens that was asked for or the best of all, with its outliers, over a board that is bent or
// not.
std::optional<LensFit> ChooseAndFit(const Setup& setup, Starts& starts,
                                    CameraCalibrationResult& result) {
  std::optional<LensModel> lens = setup.options.lens;
  if (!lens) {
    result.candidates = TryLenses(setup, starts);
    if (const auto chosen = ChooseLens(result.candidates)) lens = result.candidates[*chosen].model;
  }
  auto fit = lens ? FitLens(setup, *lens, MayWarp(setup), starts) : std::nullopt;
  if (fit && MayWarp(setup) && !DecideWarp(setup, fit->solution, result.warp_reason)) {
    fit = FitLens(setup, *lens, false, starts);
  }
  return fit;
}

// Whether the board has a shape of its own: asked for, or seen by views left out. Then `solution`
// has it.
bool DecideShape(const Setup& setup, CameraSolution& solution, std::string& reason) {
  const auto& sd_m = setup.options.board_sd_m;
  reason = "as asked for";
  if (sd_m && *sd_m <= 0) return false;
  CameraSolution shaped = solution;
  const bool found = EstimateBoardShape(shaped, sd_m);
  if (!sd_m) {
    reason = "held-out views are predicted no better with corners in places of their own";
    const auto with = found ? LeaveViewsOut(shaped, setup.options.folds) : std::nullopt;
    const auto without = LeaveViewsOut(solution, setup.options.folds);
    if (!with || !without || !ShapeHelps(*without, *with)) return false;
    reason = fmt::format(
        "held-out views are predicted better with corners in places of their own: {:.3f} instead "
        "of {:.3f} px",
        with->rms_px, without->rms_px);
  } else if (!found) {
    return false;
  }
  solution = std::move(shaped);
  return true;
}

// What is wrong with the result as a whole; empty where it can be used.
std::string NotDetermined(const CameraCalibrationResult& r) {
  const CameraCalibration& c = r.solution.camera;
  if (r.covariance.size() == 0) return "the views do not determine the camera: they are all alike";
  const auto sd = r.StandardDeviations();
  if (sd[0] > kMostFocalDeviation * c.fu_px || sd[1] > kMostFocalDeviation * c.fv_px) {
    return fmt::format(
        "the views do not tell the focal length ({:.0f} px with a standard deviation of {:.0f}): "
        "tilt the board by 30 degrees and more, in several directions",
        c.fu_px, std::max(sd[0], sd[1]));
  }
  const double most_px = kMostCentreDeviation * std::hypot(c.width_px, c.height_px);
  if (std::max(sd[2], sd[3]) > most_px) {
    return fmt::format(
        "the views do not tell the principal point (a standard deviation of {:.0f} px): tilt the "
        "board in more directions and show it all over the picture",
        std::max(sd[2], sd[3]));
  }
  return {};
}

CameraCalibrationResult Failed(CameraCalibrationResult result, CameraCalibrationStatus status,
                               const std::string& message) {
  result.status = status;
  result.message = message;
  return result;
}

void CountViews(CameraCalibrationResult& result) {
  result.views_used = static_cast<int>(std::count_if(result.views.begin(), result.views.end(),
                                                     [](const auto& v) { return v.used; }));
  result.views_rejected = static_cast<int>(result.views.size()) - result.views_used;
}

// The views as they stand after the last fit.
void MarkViews(const LensFit& fit, CameraCalibrationResult& result) {
  for (CalibrationView& view : result.views) {
    if (view.used) view.reason = "no pose of the board explains its corners";
    view.used = false;
  }
  for (const RejectedView& r : fit.rejected) result.views[r.index].reason = r.reason;
  for (const SolvedView& v : fit.solution.views) {
    result.views[v.index].used = true;
    result.views[v.index].reason.clear();
  }
  CountViews(result);
}

}  // namespace

std::vector<double> CameraCalibrationResult::StandardDeviations() const {
  std::vector<double> sd;
  for (int i = 0; i < solution.IntrinsicsCount() && i < covariance.rows(); ++i) {
    sd.push_back(std::sqrt(covariance(i, i)));
  }
  return sd;
}

CameraCalibrationResult CalibrateCamera(const std::vector<BoardView>& views, int width_px,
                                        int height_px, const BoardSpec& board,
                                        const CameraCalibrationOptions& options) {
  CheckOptions(width_px, height_px, options);
  CameraCalibrationResult result;
  Setup setup{UsableViews(views, result), width_px, height_px, FlatBoard(board), options};
  CountViews(result);
  const int needed = options.outliers.min_views;
  if (result.views_used < needed) {
    return Failed(
        result, CameraCalibrationStatus::kTooFewViews,
        fmt::format("{} usable views, at least {} are needed", result.views_used, needed));
  }
  Starts starts(setup);
  auto fit = ChooseAndFit(setup, starts, result);
  if (fit && DecideShape(setup, fit->solution, result.shape_reason)) {
    setup.shape = fit->solution.shape;  // lens and outliers anew: both may have stood in for it
    fit = ChooseAndFit(setup, starts, result);
    if (fit && !EstimateBoardShape(fit->solution, setup.shape.sd_m)) fit.reset();
  } else if (fit && options.board_sd_m.value_or(0.0) > 0) {
    return Failed(result, CameraCalibrationStatus::kNotDetermined,
                  "the views do not determine the board's shape");
  }
  if (!fit) {
    return Failed(result, CameraCalibrationStatus::kNotDetermined,
                  "the views do not determine the camera (are they all alike?)");
  }
  const auto heldout = LeaveViewsOut(fit->solution, options.folds);
  result.heldout_rms_px = heldout ? heldout->rms_px : 0.0;
  MarkViews(*fit, result);
  result.solution = std::move(fit->solution);
  result.covariance = result.solution.Covariance();
  const std::string wrong = NotDetermined(result);
  if (!wrong.empty()) return Failed(result, CameraCalibrationStatus::kNotDetermined, wrong);
  result.status = CameraCalibrationStatus::kOk;
  return result;
}

}  // namespace flextip
