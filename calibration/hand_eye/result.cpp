#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/hand_eye/work.h"

namespace flextip {
namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

struct ChainError {
  double px = kAbsent, mm = kAbsent;
  std::vector<Eigen::Vector2d> px_chain;
};

// With the wrist as measured.
ChainError ErrorOf(const HandEyeWork& work, const HandEyeState& state, const WorkView& view) {
  const CameraModel camera(state.camera);
  const Pose chain = BoardInCamera(work.mount, state.T_FC, state.T_KB, view.wrist->T_RW);
  ChainError error;
  double squared_px2 = 0, squared_m2 = 0;
  for (const Correspondence& point : view.board.points) {
    const auto px = camera.Project(chain * point.x_E);
    if (!px) return {};
    error.px_chain.push_back(*px);
    squared_px2 += (*px - point.px).squaredNorm();
    squared_m2 += (chain * point.x_E - view.SeenPose() * point.x_E).squaredNorm();
  }
  const auto count = static_cast<double>(view.board.points.size());
  error.px = std::sqrt(squared_px2 / count);
  error.mm = 1e3 * std::sqrt(squared_m2 / count);
  return error;
}

// Every view's error by frames that were found without it.
void HoldOut(const HandEyeWork& work, HandEyeResult& result) {
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < work.views.size(); ++i) {
    if (work.views[i].used) used.push_back(i);
  }
  const std::size_t folds =
      std::min<std::size_t>(used.size(), static_cast<std::size_t>(work.options.max_folds));
  for (std::size_t fold = 0; fold < folds && used.size() > 3; ++fold) {
    std::vector<std::size_t> left_out;
    for (std::size_t i = fold; i < used.size(); i += folds) left_out.push_back(used[i]);
    const auto fit = FitHandEye(work.Problem(left_out), work.state);
    if (!fit) continue;
    for (const std::size_t i : left_out) {
      const ChainError error = ErrorOf(work, fit->state, work.views[i]);
      result.views[i].held_out_px = error.px;
      result.views[i].held_out_mm = error.mm;
    }
  }
}

void FillViews(const HandEyeWork& work, HandEyeResult& result) {
  for (const WorkView& view : work.views) {
    HandEyeViewResult& out = result.views.emplace_back();
    out.name = view.given->name;
    out.t_ns = view.given->t_ns;
    out.used = view.used && result.IsUsable();
    out.reason = view.reason;
    out.held_out_px = out.held_out_mm = out.px = out.mm = kAbsent;
    out.px_seen = view.given->sighting.px;
    out.corners = static_cast<int>(view.board.points.size());
    out.board_px = view.board.RmsPx();
    (out.used ? result.views_used : result.views_rejected)++;
    out.seen = view.Usable();
    if (!out.seen || !result.IsUsable()) continue;
    const ChainError error = ErrorOf(work, work.state, view);
    out.px = error.px;
    out.mm = error.mm;
    out.px_chain = error.px_chain;
    if (!view.used) {
      out.held_out_px = error.px;
      out.held_out_mm = error.mm;
    }
    out.chi2 = view.chi2;
    out.flipped = view.candidate > 0;
    out.T_CB = work.ChainPose(view);
  }
}

// Over the corners of the views used; absent where no view has it.
double RmsOver(const std::vector<HandEyeViewResult>& views, double HandEyeViewResult::*error) {
  double squared = 0, corners = 0;
  for (const auto& view : views) {
    if (!view.used || !std::isfinite(view.*error)) continue;
    squared += view.corners * (view.*error) * (view.*error);
    corners += view.corners;
  }
  return corners > 0 ? std::sqrt(squared / corners) : kAbsent;
}

void FillUnknown(const HandEyeWork& work, HandEyeResult& result) {
  const HandEyeProblem problem = work.Problem();
  std::vector<Pose> wrists;
  for (const FitView& view : problem.views) wrists.push_back(view.wrist.T_RW);
  const WristMotion motion = MotionOf(wrists, work.noise);
  result.unobservable = UnknownCoordinates(problem, work.state, motion);
  for (const auto& unknown : result.unobservable) {
    (unknown.parameter.starts_with("camera") ? result.knows_camera : result.knows_board) = false;
  }
  if (!work.no_time_offset.empty()) {
    result.unobservable.push_back({"time_offset_s", work.no_time_offset});
  }
  result.motions = HelpfulMotions(problem, work.state, motion);
}

}  // namespace

void FillHandEyeResult(const HandEyeWork& work, HandEyeResult& result) {
  FillViews(work, result);
  result.corner_noise_px = work.noise.corner_px;
  if (!result.IsUsable()) return;
  result.T_FC = work.state.T_FC;
  result.T_KB = work.state.T_KB;
  result.time_offset_s = work.time_offset_s;
  result.has_time_offset = work.with_time_offset;
  result.has_intrinsics = work.options.refine_intrinsics;
  result.camera = work.state.camera;
  result.covariance = work.covariance;
  result.orientation_noise_scale = work.noise.orientation_rad / work.stated.orientation_rad;
  result.position_noise_scale = work.noise.position_m / work.stated.position_m;
  std::size_t next = 0;
  for (std::size_t i = 0; i < work.views.size(); ++i) {
    if (!work.views[i].used) continue;
    result.views[i].wrist_step = PoseDifference(work.views[i].wrist->T_RW, work.state.T_RW[next++]);
  }
  FillUnknown(work, result);
  if (work.options.hold_out) HoldOut(work, result);
  result.rms_px = RmsOver(result.views, &HandEyeViewResult::px);
  result.rms_mm = RmsOver(result.views, &HandEyeViewResult::mm);
  result.held_out_px = RmsOver(result.views, &HandEyeViewResult::held_out_px);
  result.held_out_mm = RmsOver(result.views, &HandEyeViewResult::held_out_mm);
}

namespace {

// Rows of the result's covariance that hold a calibration's entries, in its order.
void AddRows(std::vector<int>& rows, int first, int count) {
  for (int i = 0; i < count; ++i) rows.push_back(first + i);
}

}  // namespace

Calibration HandEyeCalibration(const HandEyeResult& result, const std::string& board) {
  const bool to_hand = result.mount == HandEyeMount::kEyeToHand;
  const std::string camera_name = to_hand ? "cam0.T_RC" : "cam0.T_WC";
  const std::string board_name =
      board == "tags0" ? "tags0.T_WE" : board + (to_hand ? ".T_WB" : ".T_RB");
  Calibration c;
  c.kind = "hand-eye";
  std::map<std::string, int> first;  // row of the result's covariance
  if (result.knows_camera) {
    c.poses[camera_name] = result.T_FC;
    first[camera_name] = 0;
  }
  if (result.knows_board) {
    c.poses[board_name] = result.T_KB;
    first[board_name] = 6;
  }
  if (result.has_time_offset) {
    c.numbers["cam0.time_offset_s"] = {result.time_offset_s};
    first["cam0.time_offset_s"] = 12;
  }
  if (result.has_intrinsics) {
    const CameraCalibration& lens = result.camera;
    c.numbers["cam0.intrinsics"] = {lens.fu_px, lens.fv_px, lens.cu_px, lens.cv_px};
    first["cam0.intrinsics"] = result.has_time_offset ? 13 : 12;
  }
  std::vector<int> rows;
  for (const auto& entry : c.poses) AddRows(rows, first[entry.first], 6);
  for (const auto& [name, values] : c.numbers) {
    AddRows(rows, first[name], static_cast<int>(values.size()));
  }
  c.covariance = result.covariance(rows, rows);
  for (const auto& [parameter, reason] : result.unobservable) {
    const auto dot = parameter.find('.');
    const std::string rest = dot == std::string::npos ? "" : parameter.substr(dot);
    const std::string name = parameter.starts_with("camera")  ? camera_name + rest
                             : parameter.starts_with("board") ? board_name + rest
                                                              : "cam0." + parameter;
    c.unobservable.push_back({name, reason});
  }
  return c;
}

}  // namespace flextip
