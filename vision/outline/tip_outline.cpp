#include "vision/outline/tip_outline.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "vision/grey.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kJoinSearch_px = 4, kJoinSteps = 2;
constexpr double kMargin_px = 45.0;
constexpr double kBlurChange = 0.15;  // of the blur, from which on it is worth a new edge model
// Squared distances over their covariances above which an outline belongs to another thing.
constexpr double kDisagree = 25.0, kFarFromExpected = 30.0;  // of 5 and of 6 degrees of freedom

ContourOptions WithBlur(ContourOptions options, double blur_px) {
  options.blur_px = blur_px;
  return options;
}

bool IsOutline(const ContourTerm& term, const ContourOptions& options) {
  return term.points >= std::max<double>(options.least_points, options.least_part * term.lines) &&
         term.rms_px <= options.most_rms_px;
}

bool HasEnd(const ContourTerm& term, const ContourOptions& options) {
  return term.lines_of[2] > 0 && term.points_of[2] >= options.least_end * term.lines_of[2];
}

// Returns the squared distance of the outline's own pose from a pose with `information`, at which
// the term was made, over the covariance of both. Roll, which the outline does not know, costs
// nothing.
double Disagreement(const ContourTerm& term, const Matrix6& information) {
  const Matrix6 alone = term.JtJ + 1e-6 * information, both = term.JtJ + information;
  return term.Jtr.dot(Ldlt(alone).Solve(term.Jtr) - Ldlt(both).Solve(term.Jtr));
}

}  // namespace

TipOutline::TipOutline(const std::vector<CameraCalibration>& cameras, const TubeShape& tube,
                       const ContourOptions& options)
    : tube_(tube), options_(options) {
  for (const CameraCalibration& c : cameras) {
    const CameraModel camera(c);
    views_.push_back({camera, options.blur_px, ShaftContour(camera, tube, options),
                      Image(c.width_px, c.height_px, 1)});
  }
}

void TipOutline::SetBlur(std::size_t camera, double blur_px) {
  View& view = views_.at(camera);
  blur_px = std::clamp(blur_px, 0.3, 4.0);
  if (std::abs(blur_px - view.blur_px) < kBlurChange * view.blur_px) return;
  view.blur_px = blur_px;
  view.contour = ShaftContour(view.camera, tube_, WithBlur(options_, blur_px));
}

void TipOutline::VisitState(StateText& state) {
  for (View& view : views_) {
    state(view.blur_px);
    if (!state.Reading()) continue;
    view.contour = ShaftContour(view.camera, tube_, WithBlur(options_, view.blur_px));
  }
}

// Makes grey values where the outline may be looked for.
const Image& TipOutline::GreyAround(View& view, const Image& image, const Pose& T_CE) const {
  if (image.channels == 1) return image;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const ContourPoint& p : TubeContour(view.camera, tube_, T_CE, {0, 0}, 8, 4)) {
    low = low.cwiseMin(p.px);
    high = high.cwiseMax(p.px);
  }
  const double right = image.width_px - 1.0, bottom = image.height_px - 1.0;
  const int x0 = static_cast<int>(std::clamp(low.x() - kMargin_px, 0.0, right));
  const int x1 = static_cast<int>(std::clamp(high.x() + kMargin_px, 0.0, right));
  const int y0 = static_cast<int>(std::clamp(low.y() - kMargin_px, 0.0, bottom));
  const int y1 = static_cast<int>(std::clamp(high.y() + kMargin_px, 0.0, bottom));
  for (int y = y0; y <= y1; ++y) {
    const std::uint8_t* from = image.Row(y) + 3 * static_cast<std::ptrdiff_t>(x0);
    std::uint8_t* to = view.grey.Row(y) + x0;
    for (int x = x0; x <= x1; ++x, from += 3) *to++ = GreyOf(from);
  }
  return view.grey;
}

std::optional<TipOutline::Joined> TipOutline::Join(const std::vector<const Image*>& images,
                                                   const TipPrediction& seen) {
  const Matrix6 information = Ldlt(seen.covariance).Inverse();
  Joined result{seen, false};
  TipPrediction& joined = result.tip;
  std::vector<Eigen::Vector2d> bends(views_.size(), options_.bend_mean);
  for (int i = 0; i < kJoinSteps; ++i) {
    Matrix6 A = information;
    Vector6 b = -information * PoseDifference(seen.T_RE, joined.T_RE);
    std::vector<ContourTerm> terms(views_.size());
    bool found = false;
    result.end_seen = false;
    for (std::size_t k = 0; k < views_.size(); ++k) {
      if (images[k] == nullptr) continue;
      const Pose& T_RC = views_[k].camera.Calibration().T_RC;
      const Pose T_CE = T_RC.Inverse() * joined.T_RE;
      const Image& grey = GreyAround(views_[k], *images[k], T_CE);
      const ContourTerm term = views_[k].contour.Linearise(grey, T_CE, bends[k], kJoinSearch_px);
      const Matrix6 information_C = Turned(information, T_RC.R.transpose());
      if (!IsOutline(term, options_) || Disagreement(term, information_C) > kDisagree) continue;
      found = true;
      result.end_seen |= HasEnd(term, options_);
      terms[k] = term;
      A += Turned(term.JtJ, T_RC.R);
      b -= Turned(term.Jtr, T_RC.R);
    }
    const Vector6 step = Ldlt(A).Solve(b);
    if (!found || !step.allFinite()) return {};
    joined.T_RE = MovePose(joined.T_RE, step);
    joined.covariance = Ldlt(A).Inverse();
    for (std::size_t k = 0; k < views_.size(); ++k) {
      const Eigen::Matrix3d R_CR = views_[k].camera.Calibration().T_RC.R.transpose();
      bends[k] += terms[k].bend_step + terms[k].bend_by_pose * Turned(step, R_CR);
    }
  }
  return result;
}

std::optional<TipPrediction> TipOutline::Find(const std::vector<const Image*>& images,
                                              const TipPrediction& expected) {
  std::optional<TipPrediction> found;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    if (images[k] == nullptr) continue;
    const TipPrediction& prior = found ? *found : expected;
    const Pose& T_RC = views_[k].camera.Calibration().T_RC;
    const Pose T_CE = T_RC.Inverse() * prior.T_RE;
    const Image& grey = GreyAround(views_[k], *images[k], T_CE);
    const ContourFit fit =
        views_[k].contour.Fit(grey, T_CE, Turned(prior.covariance, T_RC.R.transpose()));
    if (!fit.IsUsable()) continue;
    const TipPrediction here{T_RC * fit.T_CE, Turned(fit.covariance, T_RC.R)};
    const Vector6 off = PoseDifference(prior.T_RE, here.T_RE);
    if (MahalanobisSquared(off, prior.covariance) < kFarFromExpected) found = here;
  }
  return found;
}

}  // namespace flextip
