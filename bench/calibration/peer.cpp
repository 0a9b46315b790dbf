#include "bench/calibration/peer.h"

#include <ctime>
#include <opencv2/calib3d.hpp>

#include "calibration/camera/camera_calibration.h"
#include "core/error.h"
#include "vision/camera_model.h"
#include "vision/tags/reprojection.h"

namespace flextip::bench {
namespace {

int Flags(int terms) {
  int flags = 0;
  if (terms == 4) flags |= cv::CALIB_FIX_K3;
  if (terms >= 8) flags |= cv::CALIB_RATIONAL_MODEL;
  if (terms >= 12) flags |= cv::CALIB_THIN_PRISM_MODEL;
  return flags;
}

struct Points {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> seen;
};

Points AsOpenCv(const CornerSet& set) {
  Points points;
  for (const BoardSighting& s : set.seen) {
    if (!s.Found()) continue;
    points.board.emplace_back();
    points.seen.emplace_back();
    for (std::size_t i = 0; i < s.px.size(); ++i) {
      points.board.back().emplace_back(s.x_B[i].x(), s.x_B[i].y(), 0);
      points.seen.back().emplace_back(s.px[i].x(), s.px[i].y());
    }
  }
  return points;
}

cv::Mat IntrinsicsOf(const CameraCalibration& c) {
  return (cv::Mat_<double>(3, 3) << c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1);
}

Pose StartPose(const CameraCalibration& camera, const std::vector<cv::Point3f>& board,
               const std::vector<cv::Point2f>& seen) {
  cv::Mat rotation, translation;
  cv::Matx33d R;
  cv::solvePnP(board, seen, IntrinsicsOf(camera), camera.distortion_coefficients, rotation,
               translation);
  cv::Rodrigues(rotation, R);
  Pose T_CB;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T_CB.R(row, column) = R(row, column);
    T_CB.p[row] = translation.at<double>(row);
  }
  return T_CB;
}

}  // namespace

CalibrationAnswer CalibrateByOpenCv(const CornerSet& set, int terms) {
  const Points points = AsOpenCv(set);
  cv::Mat K, distortion, deviations;
  std::vector<cv::Mat> rotations, translations;
  CalibrationAnswer answer;
  const std::clock_t start = std::clock();
  answer.rms_px = cv::calibrateCamera(
      points.board, points.seen, cv::Size(set.width_px, set.height_px), K, distortion, rotations,
      translations, deviations, cv::noArray(), cv::noArray(), Flags(terms));
  answer.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  CameraCalibration& c = answer.camera;
  c.width_px = set.width_px;
  c.height_px = set.height_px;
  c.fu_px = K.at<double>(0, 0);
  c.fv_px = K.at<double>(1, 1);
  c.cu_px = K.at<double>(0, 2);
  c.cv_px = K.at<double>(1, 2);
  c.distortion = terms == 4 ? Distortion::kRadialTangential : Distortion::kOpenCv;
  c.distortion_coefficients.clear();
  for (int i = 0; i < terms; ++i) c.distortion_coefficients.push_back(distortion.at<double>(i));
  for (int i = 0; i < 4 + terms; ++i) answer.sd.push_back(deviations.at<double>(i));
  return answer;
}

CalibrationAnswer CalibrateByFlextip(const CornerSet& set, const std::optional<LensModel>& lens,
                                     std::optional<double> board_sd_m) {
  std::vector<BoardView> views;
  for (std::size_t i = 0; i < set.names.size(); ++i) views.push_back({set.names[i], set.seen[i]});
  CameraCalibrationOptions options;
  options.lens = lens;
  options.board_sd_m = board_sd_m;
  const std::clock_t start = std::clock();
  const auto result = CalibrateCamera(views, set.width_px, set.height_px, set.board, options);
  CalibrationAnswer answer;
  answer.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (!result.IsUsable()) throw WorkError(result.message);
  answer.camera = result.solution.camera;
  answer.warp = result.solution.warp;
  answer.shape = result.solution.shape;
  answer.sd = result.StandardDeviations();
  answer.rms_px = result.solution.RmsPx();
  answer.outliers = result.solution.Outliers();
  answer.solution = result.solution;
  return answer;
}

double FittedPosesRms(const CalibrationAnswer& answer, const CornerSet& set) {
  const CameraModel model(answer.camera);
  const Points points = AsOpenCv(set);
  double sum_px2 = 0;
  int corners = 0;
  for (std::size_t view = 0; view < points.seen.size(); ++view) {
    std::vector<Correspondence> seen;
    for (std::size_t i = 0; i < points.seen[view].size(); ++i) {
      const cv::Point3f b = points.board[view][i];
      const cv::Point2f p = points.seen[view][i];
      seen.push_back(
          {answer.warp.Bent({b.x, b.y, 0}) + answer.shape.Of(set.seen[view].ids[i]), {p.x, p.y}});
    }
    const auto fit = MinimiseReprojection(
        model, seen, StartPose(answer.camera, points.board[view], points.seen[view]), 50);
    if (!fit) throw WorkError("a view that was held out has no pose under this lens");
    sum_px2 += fit->error.squared_px2;
    corners += static_cast<int>(seen.size());
  }
  return std::sqrt(sum_px2 / corners);
}

}  // namespace flextip::bench
