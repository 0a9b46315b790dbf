// Hand-eye calibration beside OpenCV's methods: on small far boards whose two planar poses look
// alike, and on the tracked laparoscope.
// OpenCV's Eigen header wants Eigen first.
#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "bench/calibration/hand_eye_data.h"
#include "bench/tool.h"
#include "calibration/hand_eye/fit.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "vision/camera_model.h"
#include "vision/tags/reprojection.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::filesystem::path scope, write;
  std::string board = "chessboard:13x8:0.003", inset;
  double orientation_noise_rad = 0.002, position_noise_m = 0.00025;
  bool refine_intrinsics = false, fit_camera = false;
};

struct Frames {
  Pose T_FC, T_KB;
};

cv::Mat ToCv(const Eigen::MatrixXd& m) {
  cv::Mat out;
  cv::eigen2cv(m, out);
  return out;
}

// Board poses as OpenCV's users get them, and the wrists.
struct Poses {
  std::vector<Pose> T_RW, T_CB;
};

Poses PosesByOpenCv(const HandEyeInput& input) {
  const CameraModel model(input.camera);
  Poses poses;
  for (const HandEyeView& view : input.views) {
    std::vector<cv::Point3d> x_B;
    std::vector<cv::Point2d> plane;
    for (std::size_t i = 0; i < view.sighting.px.size(); ++i) {
      const Eigen::Vector3d ray = model.Unproject(view.sighting.px[i]).value();
      const Eigen::Vector3d& x = view.sighting.x_B[i];
      x_B.emplace_back(x.x(), x.y(), x.z());
      plane.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
    }
    if (x_B.empty()) continue;
    cv::Mat turn, shift;
    cv::solvePnP(x_B, plane, cv::Matx33d::eye(), cv::noArray(), turn, shift);
    cv::Mat R;
    cv::Rodrigues(turn, R);
    Pose T;
    cv::cv2eigen(R, T.R);
    cv::cv2eigen(shift, T.p);
    poses.T_CB.push_back(T);
    for (const auto& sample : input.wrist.samples) {
      if (sample.t_ns != view.t_ns) continue;
      poses.T_RW.push_back(Pose::FromQuaternion(*sample.value.q_RW, sample.value.p_RW));
    }
  }
  return poses;
}

// The board's frame that goes with a camera's: the mean over the views.
Pose BoardOf(const Poses& poses, const Pose& T_FC) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Pose mean;
  for (std::size_t i = 0; i < poses.T_RW.size(); ++i) {
    const Pose T_KB = poses.T_RW[i].Inverse() * T_FC * poses.T_CB[i];
    sum += T_KB.R;
    mean.p += T_KB.p / static_cast<double>(poses.T_RW.size());
  }
  const Svd svd(sum);
  mean.R = svd.U * svd.V.transpose();
  return mean;
}

Frames HandEyeByOpenCv(const Poses& poses, cv::HandEyeCalibrationMethod method) {
  std::vector<cv::Mat> R_hand, t_hand, R_board, t_board;
  for (std::size_t i = 0; i < poses.T_RW.size(); ++i) {
    const Pose T_WR = poses.T_RW[i].Inverse();  // the camera stands in R
    R_hand.push_back(ToCv(T_WR.R));
    t_hand.push_back(ToCv(T_WR.p));
    R_board.push_back(ToCv(poses.T_CB[i].R));
    t_board.push_back(ToCv(poses.T_CB[i].p));
  }
  cv::Mat R, t;
  cv::calibrateHandEye(R_hand, t_hand, R_board, t_board, R, t, method);
  Frames frames;
  cv::cv2eigen(R, frames.T_FC.R);
  cv::cv2eigen(t, frames.T_FC.p);
  frames.T_KB = BoardOf(poses, frames.T_FC);
  return frames;
}

Frames RobotWorldByOpenCv(const Poses& poses, cv::RobotWorldHandEyeCalibrationMethod method) {
  std::vector<cv::Mat> R_board, t_board, R_hand, t_hand;
  for (std::size_t i = 0; i < poses.T_RW.size(); ++i) {
    R_board.push_back(ToCv(poses.T_CB[i].R));
    t_board.push_back(ToCv(poses.T_CB[i].p));
    R_hand.push_back(ToCv(poses.T_RW[i].R));
    t_hand.push_back(ToCv(poses.T_RW[i].p));
  }
  // A X = Z B with A = T_CB, B = T_RW: X = T_BW, Z = T_CR.
  cv::Mat R_X, t_X, R_Z, t_Z;
  cv::calibrateRobotWorldHandEye(R_board, t_board, R_hand, t_hand, R_X, t_X, R_Z, t_Z, method);
  Pose inverse_FC, inverse_KB;
  cv::cv2eigen(R_Z, inverse_FC.R);
  cv::cv2eigen(t_Z, inverse_FC.p);
  cv::cv2eigen(R_X, inverse_KB.R);
  cv::cv2eigen(t_X, inverse_KB.p);
  return {inverse_FC.Inverse(), inverse_KB.Inverse()};
}

struct Method {
  const char* name;
  std::function<Frames(const Poses&)> run;
};

std::vector<Method> Methods() {
  const auto hand_eye = [](cv::HandEyeCalibrationMethod m) {
    return [m](const Poses& p) { return HandEyeByOpenCv(p, m); };
  };
  const auto robot_world = [](cv::RobotWorldHandEyeCalibrationMethod m) {
    return [m](const Poses& p) { return RobotWorldByOpenCv(p, m); };
  };
  return {{"OpenCV Tsai", hand_eye(cv::CALIB_HAND_EYE_TSAI)},
          {"OpenCV Park", hand_eye(cv::CALIB_HAND_EYE_PARK)},
          {"OpenCV Horaud", hand_eye(cv::CALIB_HAND_EYE_HORAUD)},
          {"OpenCV Andreff", hand_eye(cv::CALIB_HAND_EYE_ANDREFF)},
          {"OpenCV Daniilidis", hand_eye(cv::CALIB_HAND_EYE_DANIILIDIS)},
          {"OpenCV Shah", robot_world(cv::CALIB_ROBOT_WORLD_HAND_EYE_SHAH)},
          {"OpenCV Li", robot_world(cv::CALIB_ROBOT_WORLD_HAND_EYE_LI)}};
}

// Linear least squares of the two rays' equations, as upstream triangulates.
Eigen::Vector3d Triangulate(const Pose& T_21, const Eigen::Vector3d& ray1,
                            const Eigen::Vector3d& ray2) {
  Eigen::Matrix<double, 4, 3> A;
  Eigen::Vector4d b;
  A << 1, 0, -ray1.x() / ray1.z(), 0, 1, -ray1.y() / ray1.z(),
      T_21.R.row(0) - ray2.x() / ray2.z() * T_21.R.row(2),
      T_21.R.row(1) - ray2.y() / ray2.z() * T_21.R.row(2);
  b << 0, 0, ray2.x() / ray2.z() * T_21.p.z() - T_21.p.x(),
      ray2.y() / ray2.z() * T_21.p.z() - T_21.p.y();
  return LeastSquares(A, b);
}

// Upstream's measures over all views, the wrists as measured: RMS distance of the corners in the
// picture, and of corners triangulated from each view and the next from where the chain has them.
struct UpstreamError {
  double px = 0, mm = 0;
};

UpstreamError UpstreamErrorOf(const HandEyeInput& input, const CameraCalibration& camera,
                              const Frames& frames, const std::vector<Pose>& T_RW) {
  const CameraModel model(camera);
  std::vector<const HandEyeView*> views;
  for (const auto& view : input.views) {
    if (view.sighting.Found()) views.push_back(&view);
  }
  double px2 = 0, m2 = 0, px_count = 0, m_count = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t j = (i + 1) % views.size();
    const Pose T_CB = frames.T_FC.Inverse() * T_RW[i] * frames.T_KB;
    const Pose T_21 = frames.T_FC.Inverse() * T_RW[j] * frames.T_KB * T_CB.Inverse();
    const BoardSighting &a = views[i]->sighting, &b = views[j]->sighting;
    for (std::size_t k = 0; k < a.px.size(); ++k) {
      const auto px = model.Project(T_CB * a.x_B[k]);
      px2 += px ? (*px - a.px[k]).squaredNorm() : 1e6;
      ++px_count;
      const auto same = std::find(b.ids.begin(), b.ids.end(), a.ids[k]);
      if (same == b.ids.end()) continue;
      const Eigen::Vector3d x = Triangulate(T_21, model.Unproject(a.px[k]).value(),
                                            model.Unproject(b.px[same - b.ids.begin()]).value());
      m2 += (x - T_CB * a.x_B[k]).squaredNorm();
      ++m_count;
    }
  }
  return {std::sqrt(px2 / px_count), 1e3 * std::sqrt(m2 / m_count)};
}

void CompareFarBoards(int views, double distance_m, double tilt_rad, double noise_px) {
  constexpr int kRuns = 20;
  fmt::print("\nfar boards: {} views at {} m, tilted up to {} rad, {} px; median and worst of {}\n",
             views, distance_m, tilt_rad, noise_px, kRuns);
  std::map<std::string, std::vector<double>> mm;
  int flipped = 0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const FarBoards far = MakeFarBoards(views, distance_m, tilt_rad, noise_px, run);
    const Poses poses = PosesByOpenCv(far.input);
    for (const Method& method : Methods()) {
      double error = HUGE_VAL;
      try {
        error = 1e3 * (method.run(poses).T_FC.p - far.T_FC.p).norm();
      } catch (const cv::Exception&) {
      }
      mm[method.name].push_back(std::isfinite(error) ? error : 1e9);
    }
    const auto ours = CalibrateHandEye(far.input, {.hold_out = false});
    for (const auto& view : ours.views) flipped += view.flipped;
    mm["flextip"].push_back(ours.IsUsable() ? 1e3 * (ours.T_FC.p - far.T_FC.p).norm() : 1e9);
  }
  for (const auto& [name, errors] : mm) {
    fmt::print("  {:18} {:10.2f} {:12.2f} mm\n", name, Median(errors), LowerQuantile(errors, 1.0));
  }
  fmt::print("  {:.1f} of {} views were flipped\n", flipped / static_cast<double>(kRuns), views);
}

HandEyeInput WithViews(const HandEyeInput& input, const HandEyeResult& result) {
  HandEyeInput some = input;
  some.views.clear();
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    if (result.views[i].used) some.views.push_back(input.views[i]);
  }
  return some;
}

void PrintUpstream(const char* name, const UpstreamError& error) {
  fmt::print("  {:24} {:8.2f} px {:8.2f} mm\n", name, error.px, error.mm);
}

// The least distance in the picture near `start`: the wrists taken as exact.
Frames LeastPixels(const HandEyeInput& input, const HandEyeResult& start) {
  HandEyeProblem problem;
  problem.noise = {1.0, 1e-7, 1e-8};
  for (const HandEyeView& view : input.views) {
    FitView& one = problem.views.emplace_back();
    for (std::size_t i = 0; i < view.sighting.px.size(); ++i) {
      one.points.push_back({view.sighting.x_B[i], view.sighting.px[i]});
    }
    one.wrist = WristAround(input.wrist, view.t_ns).value();
  }
  const auto fit = FitHandEye(problem, {start.T_FC, start.T_KB, input.camera, 0.0, {}});
  if (!fit) throw WorkError("the fit of least pixels did not converge");
  return {fit->state.T_FC, fit->state.T_KB};
}

void CompareOn(const HandEyeInput& input, const HandEyeResult& ours) {
  const Poses poses = PosesByOpenCv(input);
  fmt::print("upstream's measures over {} views, in sample\n", poses.T_CB.size());
  const auto print = [&](const char* name, const Frames& frames, const CameraCalibration& camera) {
    PrintUpstream(name, UpstreamErrorOf(input, camera, frames, poses.T_RW));
  };
  for (const Method& method : Methods()) print(method.name, method.run(poses), input.camera);
  print("flextip", {ours.T_FC, ours.T_KB}, ours.camera);
  print("pixels alone", LeastPixels(input, ours), input.camera);
}

void CompareScope(const Arguments& a) {
  const BoardSpec board = ParseBoardSpec(a.board);
  std::optional<BoardSpec> inset;
  if (!a.inset.empty()) inset = ParseBoardSpec(a.inset);
  HandEyeInput input =
      ReadTrackedScope(a.scope, board, inset, a.orientation_noise_rad, a.position_noise_m);
  if (a.fit_camera) FitScopeCamera(board, input);
  const auto start = std::chrono::steady_clock::now();
  const auto r = CalibrateHandEye(input, {.refine_intrinsics = a.refine_intrinsics});
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (!r.IsUsable()) throw WorkError(r.message);
  fmt::print("tracked scope, {}: {} of {} views used, {:.2f} s\n", a.board, r.views_used,
             r.views.size(), seconds.count());
  fmt::print("{:.2f} px, {:.2f} mm; held out {:.2f} px, {:.2f} mm; corners' noise {:.2f} px\n",
             r.rms_px, r.rms_mm, r.held_out_px, r.held_out_mm, r.corner_noise_px);
  fmt::print("tracker's noise: {:.2f} deg, {:.2f} mm an axis\n",
             57.3 * r.orientation_noise_scale * a.orientation_noise_rad,
             1e3 * r.position_noise_scale * a.position_noise_m);
  for (const auto& view : r.views) {
    if (!view.used) fmt::print("not used: {}: {}\n", view.name, view.reason);
  }
  CompareOn(input, r);
  CompareOn(WithViews(input, r), r);
}

void Run(Arguments& a) {
  if (!a.scope.empty()) CompareScope(a);
  if (!a.write.empty()) {
    WriteTrackedScope(a.scope, a.write, a.orientation_noise_rad, a.position_noise_m);
  }
  if (!a.scope.empty()) return;
  CompareFarBoards(20, 0.25, 0.5, 0.1);
  CompareFarBoards(20, 0.6, 0.5, 0.3);
  CompareFarBoards(20, 1.0, 0.5, 0.3);
  CompareFarBoards(20, 1.0, 0.25, 0.5);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  using flextip::bench::Arguments;
  return flextip::bench::RunTool<Arguments>(
      argc, argv, "Hand-eye calibration beside OpenCV's",
      [](CLI::App& app, Arguments& a) {
        app.add_option("--scope", a.scope,
                       "The tracked laparoscope's folder; without it made-up boards");
        app.add_option("--board", a.board, "As calibrate takes it");
        app.add_option("--inset", a.inset, "A second board in the middle of it, a quarter turned");
        app.add_flag("--fit-camera", a.fit_camera, "The lens by the same pictures");
        app.add_option("--write", a.write, "Write the scope as a recording there");
        app.add_option("--orientation-noise", a.orientation_noise_rad, "Of the tracker (rad)");
        app.add_option("--position-noise", a.position_noise_m, "Of the tracker (m)");
        app.add_flag("--refine-intrinsics", a.refine_intrinsics, "Focal lengths and centre too");
      },
      flextip::bench::Run);
}
