#include "vision/outline/contour.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "vision/outline/contour_coarse.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kMaxIterations = 12, kWideIterations = 2;
constexpr int kWideSearch_px = 8;  // after the vote
// Limit of the squared step over the covariance. Scan lines move with the pose and see another part
// of the background: at six, all errors would be drawn anew.
constexpr double kSettled = 1e-2, kNearlySettled = 3.0;
constexpr int kLeastOfPart = 3;

void CheckGrey(const Image& image) {
  if (image.Empty() || image.channels != 1) {
    throw InputError(fmt::format("contour: expected a grey image, found {}x{} with {} channels",
                                 image.width_px, image.height_px, image.channels));
  }
}

// Returns the pose that brings the outline's points nearest to their new places, with the prior.
Vector6 StepToward(const std::vector<ContourPoint>& points, const std::vector<double>& outward_px,
                   const Matrix6& information, bool sides, bool end) {
  Matrix6 A = information;
  Vector6 b = Vector6::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_end = points[i].part == ContourPart::kEnd;
    if (is_end ? !end : !sides) continue;
    A += points[i].J_pose.transpose() * points[i].J_pose;
    b += points[i].J_pose.transpose() * outward_px[i];
  }
  return Ldlt(A).Solve(b);
}

}  // namespace

ShaftContour::ShaftContour(const CameraModel& camera, const TubeShape& tube,
                           const ContourOptions& options)
    : camera_(camera),
      tube_(tube),
      options_(options),
      finder_(camera.Calibration().gamma.value_or(options.unknown_gamma), options.blur_px) {
  const auto check = [](double value, const char* name) {
    if (!(value > 0) || !std::isfinite(value)) {
      throw InputError(fmt::format("contour: {} must be positive, found {}", name, value));
    }
  };
  check(tube.diameter_m, "diameter_m");
  check(tube.length_m - tube.diameter_m, "length less diameter");
  check(options.errors.inset_px, "inset_px");
  check(options.errors.side_px, "side_px");
  check(options.errors.end_px, "end_px");
  check(options.bend_covariance.determinant(), "bend_covariance's determinant");
}

std::vector<ContourPoint> ShaftContour::Outline(const Pose& T_CE,
                                                const Eigen::Vector2d& bend) const {
  return TubeContour(camera_, tube_, T_CE, bend, options_.lines_per_side, options_.lines_at_end);
}

ContourTerm ShaftContour::Linearise(const Image& grey, const Pose& T_CE,
                                    const Eigen::Vector2d& bend, int search_px) const {
  CheckGrey(grey);
  auto lines = MeasureLines(finder_, grey, Outline(T_CE, bend), search_px);
  ContourPrior prior;
  prior.bend_off = bend - options_.bend_mean;
  prior.bend_information = options_.bend_covariance.inverse();
  prior.errors = options_.errors;
  return MakeTerm(lines, prior);
}

// Finds the sides first: at their place the end's lines cross the end. Returns false where another
// place fits nearly as well.
bool ShaftContour::FindRoughly(const Image& grey, const Matrix6& information, Pose& T_CE) const {
  bool clear = true;
  for (const bool along : {false, true}) {
    const auto points = Outline(T_CE, options_.bend_mean);
    const auto shift = along ? ShiftAlong(finder_, grey, points, options_.search_px)
                             : ShiftAside(finder_, grey, points, options_.search_px);
    if (!shift) continue;
    clear = clear && !shift->ambiguous;
    T_CE = MovePose(T_CE, StepToward(points, shift->outward_px, information, true, along));
  }
  return clear;
}

// Judges the term. Only the end itself tells the end's place. An occluder's edge across the tube
// may look like a part of the end, so most of the end must agree.
ContourStatus ShaftContour::Judge(const ContourTerm& term) const {
  const auto [left, right, end] = term.points_of;
  if (term.points < options_.least_points || left < kLeastOfPart || right < kLeastOfPart ||
      end < std::max<double>(kLeastOfPart, options_.least_end * term.lines_of[2])) {
    return ContourStatus::kTooFewPoints;
  }
  const bool few = term.points < options_.least_part * term.lines;
  if (few || term.rms_px > options_.most_rms_px) return ContourStatus::kAmbiguous;
  return ContourStatus::kOk;
}

ContourFit ShaftContour::Fit(const Image& grey, const Pose& predicted,
                             const Matrix6& covariance) const {
  CheckGrey(grey);
  const Matrix6 information = Ldlt(covariance).Inverse();
  ContourFit fit;
  fit.T_CE = predicted;
  fit.bend = options_.bend_mean;
  const bool wide = options_.search_px > kWideSearch_px;
  const bool clear = !wide || FindRoughly(grey, information, fit.T_CE);
  double moved = HUGE_VAL;
  for (fit.iterations = 1; fit.iterations <= kMaxIterations; ++fit.iterations) {
    const int search = fit.iterations <= kWideIterations
                           ? std::min(kWideSearch_px, options_.search_px)
                           : options_.fine_search_px;
    fit.term = Linearise(grey, fit.T_CE, fit.bend, search);
    if (fit.term.points == 0) return fit;
    const Matrix6 A = fit.term.JtJ + information;
    const Vector6 b = fit.term.Jtr + information * PoseDifference(predicted, fit.T_CE);
    const Vector6 step = -Ldlt(A).Solve(b);
    fit.covariance = Ldlt(A).Inverse();
    if (!step.allFinite()) break;
    fit.T_CE = MovePose(fit.T_CE, step);
    fit.bend += fit.term.bend_step + fit.term.bend_by_pose * step;
    moved = step.dot(A * step);
    if (fit.iterations > kWideIterations && moved < kSettled) break;
  }
  fit.status = Judge(fit.term);
  if (fit.status == ContourStatus::kOk && !clear) fit.status = ContourStatus::kAmbiguous;
  if (fit.status == ContourStatus::kOk && moved > kNearlySettled) {
    fit.status = ContourStatus::kNotConverged;
  }
  return fit;
}

}  // namespace flextip
