#include "calibration/hand_eye/hand_eye.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/hand_eye/work.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr int kMinViews = 3, kMaxRounds = 15;
constexpr double kChi2Median = 5.348, kChi2Limit = 27.86;  // six degrees of freedom; 1 in 10000
constexpr double kOffsetScan_s = 0.3, kOffsetStep_s = 0.025;
constexpr double kSameOffset_s = 1e-6, kSameNoise = 0.01;
constexpr double kKnownOffset_s = 0.05;
constexpr double kDoubtfulNoise = 10.0;  // over the stated one

// By how much each view's seen board differs from the chain's.
void JudgeViews(HandEyeWork& work) {
  for (WorkView& view : work.views) {
    if (!view.Usable()) continue;
    const Pose chain = work.ChainPose(view);
    view.chi2 = HUGE_VAL;
    for (std::size_t i = 0; i < view.board.poses.size(); ++i) {
      const BoardPose& pose = view.board.poses[i];
      const Vector6d r = PoseDifference(pose.T_CB, chain);
      const Matrix6d C = work.DifferenceCovariance(view, pose.information_px2, !view.used);
      const double worse = pose.squared_px2 - view.board.poses.front().squared_px2;
      const double chi2 =
          r.dot(Ldlt(C).Solve(r)) + worse / (work.noise.corner_px * work.noise.corner_px);
      if (chi2 >= view.chi2) continue;
      view.chi2 = chi2;
      view.candidate = static_cast<int>(i);
    }
  }
}

double MedianChi2(HandEyeWork& work) {
  JudgeViews(work);
  std::vector<double> all;
  for (const WorkView& view : work.views) {
    if (view.Usable()) all.push_back(view.chi2);
  }
  return Median(all);
}

void ScaleWristNoise(HandEyeWork& work, double scale) {
  work.noise.orientation_rad = scale * work.stated.orientation_rad;
  work.noise.position_m = scale * work.stated.position_m;
}

// The wrist's noise, at least the stated one, with which half of the views are within what half of
// all should be within: bad views have no say.
void ScaleByMedian(HandEyeWork& work) {
  double low = 1.0, high = 1.0;
  while (MedianChi2(work) > kChi2Median && high < 1e4) {
    low = high;
    high *= 2;
    ScaleWristNoise(work, high);
  }
  for (int i = 0; i < 12 && high > low; ++i) {
    const double middle = std::sqrt(low * high);
    ScaleWristNoise(work, middle);
    (MedianChi2(work) > kChi2Median ? low : high) = middle;
  }
  ScaleWristNoise(work, high);
}

std::string WhyNotUsed(const HandEyeWork& work, const WorkView& view) {
  const Vector6d r = PoseDifference(view.SeenPose(), work.ChainPose(view));
  const auto& pose = view.board.poses[static_cast<std::size_t>(view.candidate)];
  const Matrix6d C = work.DifferenceCovariance(view, pose.information_px2, true);
  constexpr double kDegrees = 180 / M_PI;
  return fmt::format(
      "the board is {:.1f} mm and {:.2f} deg away from where the wrist puts it; noise explains "
      "{:.1f} mm and {:.2f} deg",
      1e3 * r.tail<3>().norm(), kDegrees * r.head<3>().norm(),
      1e3 * std::sqrt(C.bottomRightCorner<3, 3>().trace()),
      kDegrees * std::sqrt(C.topLeftCorner<3, 3>().trace()));
}

// Which views are used; whether that is another choice than before.
bool ChooseViews(HandEyeWork& work) {
  JudgeViews(work);
  bool changed = false;
  for (WorkView& view : work.views) {
    const bool used = view.Usable() && view.chi2 < kChi2Limit;
    changed = changed || used != view.used;
    view.used = used;
  }
  return changed;
}

// The time offset with which poses alone fit best, roughly: the fit needs a start.
void ScanTimeOffset(HandEyeWork& work) {
  const auto usable = work.PoseViews().size();
  double best_score = HUGE_VAL, best_s = 0.0;
  HandEyeState best = work.state;
  const int steps = static_cast<int>(std::lround(kOffsetScan_s / kOffsetStep_s));
  for (int i = -steps; i <= steps; ++i) {
    work.time_offset_s = i * kOffsetStep_s;
    work.MeasureWrists();
    const auto views = work.PoseViews();
    if (2 * views.size() < usable || views.size() < kMinViews) continue;
    const auto start = RefineHandEyeStart(work.mount, views, work.state.T_FC, work.state.T_KB);
    const double score = start.score / static_cast<double>(views.size());
    if (score >= best_score) continue;
    best_score = score;
    best_s = work.time_offset_s;
    best.T_FC = start.T_FC;
    best.T_KB = start.T_KB;
  }
  work.time_offset_s = best_s;
  work.state = best;
  work.MeasureWrists();
}

void JudgeTimeOffset(HandEyeWork& work) {
  if (!work.options.estimate_time_offset) return;
  work.no_time_offset = NoTimeOffsetReason(work.Problem());
  work.with_time_offset = work.no_time_offset.empty();
}

// One fit with the present views, offset and noises, which it improves; how much it changed them.
struct Change {
  bool ok = false;
  double offset_s = 0.0, noise = 0.0;
};

Change FitOnce(HandEyeWork& work) {
  work.state.time_step_s = 0.0;
  const auto fit = FitHandEye(work.Problem(), work.state);
  if (!fit) return {};
  Change change{true, fit->state.time_step_s, 0.0};
  work.state = fit->state;
  work.covariance = fit->covariance;
  work.time_offset_s += fit->state.time_step_s;
  work.state.time_step_s = 0.0;
  const HandEyeNoise before = work.noise;
  const auto improve = [&](double& noise, double variance, double least, double was) {
    noise = std::max(least, was * std::sqrt(std::clamp(variance, 0.05, 20.0)));
    change.noise = std::max(change.noise, std::abs(std::log(noise / was)));
  };
  improve(work.noise.corner_px, fit->variances.corner, 0.02, before.corner_px);
  improve(work.noise.orientation_rad, fit->variances.orientation, work.stated.orientation_rad,
          before.orientation_rad);
  improve(work.noise.position_m, fit->variances.position, work.stated.position_m,
          before.position_m);
  if (work.with_time_offset) work.MeasureWrists();
  if (work.options.refine_intrinsics) {
    const CameraModel camera(work.state.camera);
    for (WorkView& view : work.views) RefitSeenBoard(camera, view.board);
  }
  return change;
}

bool FitAll(HandEyeWork& work) {
  for (int round = 0; round < kMaxRounds; ++round) {
    for (WorkView& view : work.views) view.used = view.used && view.Usable();
    if (work.Used() < kMinViews) return false;
    const Change change = FitOnce(work);
    if (!change.ok) return false;
    // Late rounds only settle: a view on the edge may go in and out for ever.
    const bool other_views = round < kMaxRounds / 2 && ChooseViews(work);
    if (!other_views && std::abs(change.offset_s) < kSameOffset_s && change.noise < kSameNoise)
      break;
  }
  JudgeViews(work);
  return true;
}

bool Start(HandEyeWork& work) {
  const auto start = FindHandEyeStart(work.mount, work.PoseViews(), work.options.seed);
  if (!start) return false;
  work.state.T_FC = start->T_FC;
  work.state.T_KB = start->T_KB;
  for (WorkView& view : work.views) view.used = view.Usable();
  JudgeTimeOffset(work);
  if (work.with_time_offset) ScanTimeOffset(work);
  ScaleByMedian(work);
  ChooseViews(work);
  JudgeTimeOffset(work);  // the wrist may be noisier than stated
  return true;
}

void DropUnknownTimeOffset(HandEyeWork& work) {
  if (!work.with_time_offset) return;
  const double sd_s = std::sqrt(work.covariance(kTimeColumn, kTimeColumn));
  if (sd_s < kKnownOffset_s) return;
  work.no_time_offset = fmt::format("the wrist moved too slowly: known to {:.2g} s only", sd_s);
  work.with_time_offset = false;
  work.time_offset_s = 0.0;
  work.MeasureWrists();
  FitAll(work);
}

// Frames of which few views approve, or only with a wrist far worse than stated.
bool IsDoubtful(const HandEyeWork& work) {
  return 2 * work.Used() <= static_cast<int>(work.PoseViews().size()) ||
         work.noise.orientation_rad > kDoubtfulNoise * work.stated.orientation_rad ||
         work.noise.position_m > kDoubtfulNoise * work.stated.position_m;
}

bool FitViews(HandEyeWork& work) {
  if (!Start(work) || !FitAll(work)) return false;
  DropUnknownTimeOffset(work);
  return true;
}

// Whether the views fit with camera and board in each other's place.
bool FitsTheOtherWay(HandEyeInput input, const HandEyeOptions& options) {
  input.mount =
      input.mount == HandEyeMount::kEyeToHand ? HandEyeMount::kEyeInHand : HandEyeMount::kEyeToHand;
  HandEyeWork work = BeginHandEye(input, options);
  return FitViews(work) && !IsDoubtful(work);
}

// Why the views tell nothing; `message` is empty where they tell something.
struct FitFailure {
  std::string message;
  bool fits_other_mount = false;
};

// Fits all views, and where that fails looks for the reason.
FitFailure FitOrExplain(HandEyeWork& work, const HandEyeInput& input) {
  const bool fits = FitViews(work);
  if (fits && !IsDoubtful(work)) return {};
  if (FitsTheOtherWay(input, work.options)) {
    return {work.mount == HandEyeMount::kEyeToHand
                ? "the views fit only if the camera is on the wrist"
                : "the views fit only if the board is on the wrist",
            true};
  }
  const auto usable = work.PoseViews().size();
  if (!fits) return {"no frames fit three of the views"};
  if (2 * work.Used() > static_cast<int>(usable)) return {};
  return {fmt::format("only {} of {} views agree: wrong wrist poses, board or clocks", work.Used(),
                      usable)};
}

}  // namespace

HandEyeResult CalibrateHandEye(const HandEyeInput& input, const HandEyeOptions& options) {
  HandEyeWork work = BeginHandEye(input, options);
  HandEyeResult result;
  result.mount = input.mount;
  const auto finish = [&](HandEyeStatus status, const std::string& message) {
    result.status = status;
    result.message = message;
    FillHandEyeResult(work, result);
    return result;
  };
  const auto usable = work.PoseViews().size();
  if (usable < kMinViews) {
    return finish(
        HandEyeStatus::kTooFewViews,
        fmt::format("{} views with board and wrist, at least {} are needed", usable, kMinViews));
  }
  const FitFailure failure = FitOrExplain(work, input);
  result.fits_other_mount = failure.fits_other_mount;
  if (!failure.message.empty()) return finish(HandEyeStatus::kNotConverged, failure.message);
  for (WorkView& view : work.views) {
    if (view.Usable() && !view.used) view.reason = WhyNotUsed(work, view);
    if (view.used) view.reason.clear();
  }
  return finish(HandEyeStatus::kOk, "");
}

}  // namespace flextip
