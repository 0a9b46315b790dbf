#include "calibration/hand_eye/work.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

// No robot, tracker or corner is better: stated noises are not taken below these.
constexpr double kLeast_px = 0.02, kLeast_rad = 1e-5, kLeast_m = 1e-5;
constexpr double kPoorOfMedian = 4.0;  // a view's error over the median's

// Marks the views whose corners fit no board; the noise of the others' corners.
double JudgeBoards(std::vector<WorkView>& views) {
  std::vector<double> all_px;
  for (const WorkView& view : views) {
    if (!view.board.poses.empty()) all_px.push_back(view.board.RmsPx());
  }
  const double median_px = Median(all_px);
  double squared = 0, dof = 0;
  for (WorkView& view : views) {
    if (view.board.poses.empty()) {
      view.reason = view.board.reason.empty() ? "no board seen" : view.board.reason;
    } else if (view.board.RmsPx() > kPoorOfMedian * median_px + kLeast_px) {
      view.reason = fmt::format("the corners fit no board: {:.2f} px, in most views {:.2f} px",
                                view.board.RmsPx(), median_px);
    } else {
      view.fits_board = true;
      squared += view.board.poses.front().squared_px2;
      dof += view.board.Dof();
    }
  }
  return std::max(kLeast_px, dof > 0 ? std::sqrt(squared / dof) : 0.0);
}

}  // namespace

void HandEyeWork::MeasureWrists() {
  const auto offset_ns = static_cast<TimeNs>(std::llround(1e9 * time_offset_s));
  for (WorkView& view : views) view.wrist = WristAround(*stream, view.given->t_ns + offset_ns);
}

int HandEyeWork::Used() const {
  return static_cast<int>(
      std::count_if(views.begin(), views.end(), [](const WorkView& v) { return v.used; }));
}

HandEyeProblem HandEyeWork::Problem(const std::vector<std::size_t>& left_out) const {
  HandEyeProblem problem{mount, noise, {}, with_time_offset, options.refine_intrinsics};
  for (std::size_t i = 0; i < views.size(); ++i) {
    const bool left = std::find(left_out.begin(), left_out.end(), i) != left_out.end();
    if (views[i].used && !left) problem.views.push_back({views[i].board.points, *views[i].wrist});
  }
  return problem;
}

std::vector<PoseView> HandEyeWork::PoseViews() const {
  const double variance = noise.corner_px * noise.corner_px;
  std::vector<PoseView> pose_views;
  for (const WorkView& view : views) {
    if (!view.Usable()) continue;
    PoseView& one = pose_views.emplace_back();
    one.T_RW = view.wrist->T_RW;
    one.wrist_covariance = noise.WristCovariance(view.wrist->noise_share);
    for (const BoardPose& pose : view.board.poses) {
      const double worse = pose.squared_px2 - view.board.poses.front().squared_px2;
      one.candidates.push_back(
          {pose.T_CB, variance * Lu(pose.information_px2).Inverse(), worse / variance});
    }
  }
  return pose_views;
}

Matrix6d HandEyeWork::DifferenceCovariance(const WorkView& view, const Matrix6d& information_px2,
                                           bool with_frames) const {
  const auto J = ChainJacobian(mount, state.T_FC, state.T_KB, view.wrist->T_RW);
  const Matrix6d J_wrist = J.rightCols<6>();
  Matrix6d sum = noise.corner_px * noise.corner_px * Lu(information_px2).Inverse();
  sum += J_wrist * noise.WristCovariance(view.wrist->noise_share) * J_wrist.transpose();
  if (with_frames && covariance.rows() >= 12) {
    const Eigen::Matrix<double, 6, 12> J_frames = J.leftCols<12>();
    sum += J_frames * covariance.topLeftCorner<12, 12>() * J_frames.transpose();
  }
  return sum;
}

Pose HandEyeWork::ChainPose(const WorkView& view) const {
  return BoardInCamera(mount, state.T_FC, state.T_KB, view.wrist->T_RW);
}

HandEyeWork BeginHandEye(const HandEyeInput& input, const HandEyeOptions& options) {
  if (input.wrist.samples.empty()) throw InputError("wrist0: there are no samples");
  const CameraModel camera(input.camera);
  HandEyeWork work;
  work.mount = input.mount;
  work.options = options;
  work.stream = &input.wrist;
  work.state.camera = input.camera;
  for (const HandEyeView& view : input.views) {
    WorkView& one = work.views.emplace_back();
    one.given = &view;
    one.board = FitSeenBoard(camera, view.sighting);
  }
  work.stated = {JudgeBoards(work.views), std::max(kLeast_rad, input.wrist.orientation_noise_rad),
                 std::max(kLeast_m, input.wrist.position_noise_m)};
  work.noise = work.stated;
  work.MeasureWrists();
  for (WorkView& view : work.views) {
    if (view.fits_board && !view.wrist) {
      view.reason =
          "the wrist's pose is not known at that time (wrist0 has no orientation, or a gap)";
    }
  }
  return work;
}

}  // namespace flextip
