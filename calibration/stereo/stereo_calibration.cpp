#include "calibration/stereo/stereo_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/camera/board_shape.h"
#include "calibration/camera/choice.h"
#include "calibration/stereo/bundle.h"
#include "calibration/stereo/heldout.h"
#include "core/median.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr int kRounds = 8;
constexpr double kLeastNoise_px = 1e-3;
// A pair's corners within this many px are never taken apart: synchronisation is not that bad.
constexpr double kSameMoment_px = 0.5;

StereoResult Failed(StereoResult result, StereoStatus status, const std::string& message) {
  result.status = status;
  result.message = message;
  return result;
}

CameraCalibrationResult CalibrateEye(const std::vector<StereoPair>& pairs, int eye,
                                     const Eigen::Vector2i& size_px, const BoardSpec& board,
                                     const StereoOptions& options) {
  std::vector<BoardView> views;
  views.reserve(pairs.size());
  for (const StereoPair& pair : pairs) views.push_back(pair.eyes[eye]);
  return CalibrateCamera(views, size_px.x(), size_px.y(), board, options.camera);
}

// The pairs' views by their place among all pairs.
std::map<std::size_t, SolvedView> ByIndex(const CameraSolution& solution) {
  std::map<std::size_t, SolvedView> views;
  for (const SolvedView& view : solution.views) views[view.index] = view;
  return views;
}

// How far two poses of camera 1 in camera 0 differ for something `depth_m` away.
double Apart(const Pose& a, const Pose& b, double depth_m) {
  return (a.p - b.p).norm() + depth_m * LogRotation(a.R.transpose() * b.R).norm();
}

// The pair's pose that is nearest to all the others: one that is wrong does not pull it.
std::optional<Pose> MiddlePose(const std::vector<Pose>& candidates, double depth_m) {
  std::optional<Pose> best;
  double least = HUGE_VAL;
  for (const Pose& candidate : candidates) {
    double sum = 0.0;
    for (const Pose& other : candidates) sum += Apart(candidate, other, depth_m);
    if (sum >= least) continue;
    least = sum;
    best = candidate;
  }
  return best;
}

// Both eyes as each was alone, joined by the pairs' common opinion on T_C0C1.
std::optional<StereoSolution> Join(const std::array<CameraCalibrationResult, 2>& alone) {
  const auto left = ByIndex(alone[0].solution), right = ByIndex(alone[1].solution);
  std::vector<Pose> candidates;
  double depth_m = 0.0;
  for (const auto& [index, view] : left) {
    const auto other = right.find(index);
    if (other == right.end()) continue;
    candidates.push_back(view.T_CB * other->second.T_CB.Inverse());
    depth_m = std::max(depth_m, view.T_CB.p.norm());
  }
  const auto T_C0C1 = MiddlePose(candidates, depth_m);
  if (!T_C0C1) return {};
  StereoSolution s;
  s.cameras = {alone[0].solution.camera, alone[1].solution.camera};
  s.T_C0C1 = *T_C0C1;
  s.warp = alone[0].solution.warp;
  s.warp.bulge_m = 0.5 * (alone[0].solution.warp.bulge_m + alone[1].solution.warp.bulge_m);
  s.warp_estimated = alone[0].solution.warp_estimated || alone[1].solution.warp_estimated;
  for (const auto& [index, view] : left) {
    s.views.push_back({.index = index, .T_C0B = view.T_CB, .eyes = {view, SolvedView()}});
    const auto other = right.find(index);
    if (other != right.end()) s.views.back().eyes[1] = other->second;
  }
  for (const auto& [index, view] : right) {
    if (left.count(index)) continue;
    s.views.push_back({.index = index, .T_C0B = *T_C0C1 * view.T_CB, .eyes = {SolvedView(), view}});
  }
  return s;
}

double PairRms(const StereoView& view) {
  const double a = view.eyes[0].RmsPx(true), b = view.eyes[1].RmsPx(true);
  return std::sqrt(0.5 * (a * a + b * b));
}

double MedianPairRms(const StereoSolution& s) {
  std::vector<double> rms;
  for (const StereoView& view : s.views) {
    if (view.InBoth()) rms.push_back(PairRms(view));
  }
  return Median(rms);
}

// Takes the worst pair apart where its pictures, good by themselves, do not fit together.
bool TakeApart(const std::array<CameraCalibrationResult, 2>& alone, double ratio, StereoSolution& s,
               StereoResult& result) {
  StereoView* worst = nullptr;
  for (StereoView& view : s.views) {
    if (view.InBoth() && (!worst || PairRms(view) > PairRms(*worst))) worst = &view;
  }
  if (!worst) return false;
  const double limit_px = std::max(kSameMoment_px, ratio * MedianPairRms(s));
  if (PairRms(*worst) <= limit_px) return false;
  const auto left = ByIndex(alone[0].solution), right = ByIndex(alone[1].solution);
  const std::size_t index = worst->index;
  result.pairs[index].apart = fmt::format(
      "its two pictures do not show the board at one place: {:.2f} px off, more than {:.2f} px",
      PairRms(*worst), limit_px);
  StereoView other{.index = index,
                   .T_C0B = s.T_C0C1 * right.at(index).T_CB,
                   .eyes = {SolvedView(), right.at(index)}};
  worst->eyes[1] = SolvedView();
  worst->T_C0B = left.at(index).T_CB;
  s.views.push_back(std::move(other));
  return true;
}

// Whether any corner changed sides.
bool MarkCorners(double ratio, StereoSolution& s) {
  const double limit_px = ratio * std::max(kLeastNoise_px, s.noise_px);
  bool changed = false;
  for (StereoView& view : s.views) {
    for (SolvedView& eye : view.eyes) {
      for (std::size_t i = 0; i < eye.px.size(); ++i) {
        const double off_px = eye.residual_px[i].norm();
        const bool used = off_px <= limit_px;
        changed |= used != eye.IsUsed(i);
        eye.reason[i] =
            used ? "" : fmt::format("{:.3f} px off, more than {:.3f} px", off_px, limit_px);
      }
    }
  }
  return changed;
}

// Corners whose outliers are found anew, over a board that is held as it is.
bool AdjustWithOutliers(const StereoOptions& options, StereoSolution& s) {
  const StereoBundleOptions bundle{.estimate_warp = s.warp_estimated};
  for (int round = 0; round < kRounds; ++round) {
    if (!AdjustStereo(s, bundle)) return false;
    if (!MarkCorners(options.camera.outliers.corner_ratio, s)) return true;
  }
  return AdjustStereo(s, bundle);
}

bool Solve(const StereoOptions& options, StereoResult& result) {
  StereoSolution& s = result.solution;
  const StereoBundleOptions robust{.estimate_warp = s.warp_estimated, .cauchy_px = 1.0};
  if (!AdjustStereo(s, robust)) return false;
  while (TakeApart(result.alone, options.pair_ratio, s, result)) {
    if (!AdjustStereo(s, robust)) return false;
  }
  return AdjustWithOutliers(options, s);
}

bool EstimateShape(std::optional<double> sd_m, double start_sd_m, StereoSolution& s) {
  const StereoBundleOptions bundle{.estimate_warp = s.warp_estimated, .estimate_shape = true};
  return SettleBoardShape(s, sd_m, start_sd_m,
                          [&](StereoSolution& moved) { return AdjustStereo(moved, bundle); });
}

// Gives the board a shape of its own where it was asked for, or where pairs left out see it. False
// where it was asked for and the pairs do not determine it.
bool AddShape(const StereoOptions& options, int folds, StereoResult& result) {
  const auto& sd_m = options.camera.board_sd_m;
  result.shape_reason = "as asked for";
  if (sd_m && *sd_m <= 0) return true;
  const double of_eyes_m =
      std::max(result.alone[0].solution.shape.sd_m, result.alone[1].solution.shape.sd_m);
  StereoSolution shaped = result.solution;
  const bool found = (sd_m || of_eyes_m > 0) && EstimateShape(sd_m, of_eyes_m, shaped) &&
                     AdjustWithOutliers(options, shaped) &&
                     EstimateShape(shaped.shape.sd_m, 0.0, shaped);
  if (!sd_m) {
    result.shape_reason =
        "pairs left out are predicted no better with corners in places of their own";
    if (!found) return true;
    const auto with = LeavePairsOut(shaped, folds), without = LeavePairsOut(result.solution, folds);
    if (!with || !without ||
        !ShapeHelps({.squared_px2 = without->squared_px2}, {.squared_px2 = with->squared_px2})) {
      return true;
    }
    result.shape_reason = fmt::format(
        "pairs left out are predicted better with corners in places of their own: {:.3f} instead "
        "of {:.3f} px",
        with->rms_px, without->rms_px);
  }
  if (found) result.solution = std::move(shaped);
  return found;
}

void Describe(const std::vector<StereoPair>& pairs, StereoResult& result) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    StereoPairResult pair;
    for (int eye = 0; eye < 2; ++eye) {
      pair.names[eye] = pairs[i].eyes[eye].name;
      if (i < result.alone[eye].views.size()) {
        pair.reasons[eye] = result.alone[eye].views[i].reason;
      }
    }
    result.pairs.push_back(pair);
  }
}

}  // namespace

StereoResult CalibrateStereo(const std::vector<StereoPair>& pairs,
                             const std::array<Eigen::Vector2i, 2>& sizes_px, const BoardSpec& board,
                             const StereoOptions& options) {
  StereoResult result;
  for (int eye = 0; eye < 2; ++eye) {
    result.alone[eye] = CalibrateEye(pairs, eye, sizes_px[eye], board, options);
  }
  Describe(pairs, result);
  for (int eye = 0; eye < 2; ++eye) {
    if (result.alone[eye].IsUsable()) continue;
    return Failed(
        result, StereoStatus::kEyeFailed,
        fmt::format("{} camera: {}", eye == 0 ? "left" : "right", result.alone[eye].message));
  }
  auto joined = Join(result.alone);
  if (!joined) {
    return Failed(result, StereoStatus::kTooFewPairs,
                  "no pair in which both cameras see the board");
  }
  result.solution = std::move(*joined);
  if (!Solve(options, result)) {
    return Failed(result, StereoStatus::kNotDetermined,
                  "the two cameras' views do not fit together");
  }
  const auto both = std::count_if(result.solution.views.begin(), result.solution.views.end(),
                                  [](const StereoView& view) { return view.InBoth(); });
  if (!AddShape(options, std::min(options.folds, static_cast<int>(both)), result)) {
    return Failed(result, StereoStatus::kNotDetermined,
                  "the pairs do not determine the board's shape");
  }
  for (const StereoView& view : result.solution.views) {
    ++(view.InBoth() ? result.pairs_used : result.single_views_used);
  }
  result.covariance = result.solution.Covariance();
  if (result.covariance.size() == 0) {
    return Failed(result, StereoStatus::kNotDetermined,
                  "the pairs do not determine how the cameras stand to each other");
  }
  result.baseline =
      BaselineOf(result.solution.T_C0C1, result.PairCovariance().bottomRightCorner<3, 3>());
  result.epipolar_rms_px = EpipolarRmsPx(result.solution);
  result.heldout = LeavePairsOut(result.solution, std::min(options.folds, result.pairs_used));
  result.status = StereoStatus::kOk;
  return result;
}

}  // namespace flextip
