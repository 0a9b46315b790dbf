#include "calibration/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "calibration/chessboard.h"
#include "core/error.h"
#include "vision/tag_detector.h"

namespace flextip {
namespace {

using ImagePoints = std::vector<std::vector<cv::Point2f>>;
using BoardPoints = std::vector<std::vector<cv::Point3f>>;

// What OpenCV returns.
struct Fit {
  double rms_px = HUGE_VAL;
  cv::Mat K, distortion, intrinsic_deviations, view_errors;
  std::vector<cv::Mat> rotations, translations;
};

int Flags(const CameraCalibrationOptions& o) {
  const bool four = o.distortion == Distortion::kRadialTangential;
  if (!four && o.distortion != Distortion::kOpenCv) {
    throw InputError("calibration of equidistant (fisheye) cameras is not supported yet");
  }
  if (four || o.distortion_terms == 5) return four ? cv::CALIB_FIX_K3 : 0;
  if (o.distortion_terms == 8) return cv::CALIB_RATIONAL_MODEL;
  if (o.distortion_terms == 12) return cv::CALIB_RATIONAL_MODEL | cv::CALIB_THIN_PRISM_MODEL;
  throw InputError(
      fmt::format("expected 5, 8 or 12 distortion terms, found {}", o.distortion_terms));
}

int TermsOf(const CameraCalibrationOptions& o) {
  return o.distortion == Distortion::kRadialTangential ? 4 : o.distortion_terms;
}

// One calibration; `focal_px` 0 lets OpenCV guess where to start.
std::optional<Fit> FitFrom(double focal_px, const BoardPoints& board, const ImagePoints& seen,
                           cv::Size size, int flags) {
  Fit fit;
  if (focal_px > 0) {
    fit.K = (cv::Mat_<double>(3, 3) << focal_px, 0, 0.5 * (size.width - 1), 0, focal_px,
             0.5 * (size.height - 1), 0, 0, 1);
    flags |= cv::CALIB_USE_INTRINSIC_GUESS;
  }
  cv::Mat extrinsic_deviations;
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12);
  try {
    fit.rms_px = cv::calibrateCamera(board, seen, size, fit.K, fit.distortion, fit.rotations,
                                     fit.translations, fit.intrinsic_deviations,
                                     extrinsic_deviations, fit.view_errors, flags, criteria);
  } catch (const cv::Exception&) {
    return {};  // degenerate views
  }
  const double focal = fit.K.at<double>(0, 0);
  const bool sane = std::isfinite(fit.rms_px) && std::isfinite(focal) && focal > 0 &&
                    fit.K.at<double>(1, 1) > 0 && cv::checkRange(fit.distortion);
  if (!sane) return {};
  return fit;
}

// The best of several starts: from OpenCV's own guess alone the search can end in a wrong minimum,
// with a long focal length and the views all far away.
std::optional<Fit> BestFit(const BoardPoints& board, const ImagePoints& seen, cv::Size size,
                           int flags) {
  std::optional<Fit> best;
  for (const double focal_of_width : {0.0, 0.6, 1.0, 1.8}) {
    const auto fit = FitFrom(focal_of_width * size.width, board, seen, size, flags);
    if (fit && (!best || fit->rms_px < best->rms_px)) best = fit;
  }
  return best;
}

void CheckImages(const std::vector<CalibrationImage>& images) {
  if (images.empty()) throw InputError("no images to calibrate from");
  const Image& first = images.front().image;
  for (const CalibrationImage& i : images) {
    if (i.image.Empty()) throw InputError::At(i.name, 0, "the image is empty");
    if (i.image.width_px != first.width_px || i.image.height_px != first.height_px) {
      throw InputError::At(
          i.name, 0,
          fmt::format("expected {}x{} pixels as in {}, found {}x{}", first.width_px,
                      first.height_px, images.front().name, i.image.width_px, i.image.height_px));
    }
  }
}

std::vector<CalibrationView> FindBoards(const std::vector<CalibrationImage>& images,
                                        const BoardSpec& board) {
  std::vector<CalibrationView> views;
  for (const CalibrationImage& i : images) {
    CalibrationView view;
    view.name = i.name;
    view.corners_px = FindChessboard(ToGrey(i.image), board.columns, board.rows);
    view.used = !view.corners_px.empty();
    if (!view.used) {
      view.reason =
          fmt::format("no chessboard with {}x{} inner corners found", board.columns, board.rows);
    }
    views.push_back(view);
  }
  return views;
}

std::optional<Fit> FitUsedViews(const std::vector<CalibrationView>& views, const BoardSpec& board,
                                cv::Size size, int flags) {
  std::vector<cv::Point3f> points;
  for (const Eigen::Vector3d& p : ChessboardPoints(board.columns, board.rows, board.square_m)) {
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0f);
  }
  ImagePoints seen;
  for (const CalibrationView& view : views) {
    if (!view.used) continue;
    seen.emplace_back();
    for (const Eigen::Vector2d& c : view.corners_px) {
      seen.back().emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
    }
  }
  return BestFit(BoardPoints(seen.size(), points), seen, size, flags);
}

int CountUsed(const std::vector<CalibrationView>& views) {
  return static_cast<int>(
      std::count_if(views.begin(), views.end(), [](const auto& v) { return v.used; }));
}

// Takes each view's error and pose from the fit.
void FillViews(const Fit& fit, std::vector<CalibrationView>& views) {
  int i = 0;
  for (CalibrationView& view : views) {
    if (!view.used) continue;
    view.rms_px = fit.view_errors.at<double>(i);
    cv::Matx33d R;
    cv::Rodrigues(fit.rotations[i], R);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) view.T_CB.R(row, column) = R(row, column);
      view.T_CB.p[row] = fit.translations[i].at<double>(row);
    }
    ++i;
  }
}

// Whether a view was rejected because its error is far above the others'.
bool RejectWorst(const CameraCalibrationOptions& options, std::vector<CalibrationView>& views) {
  std::vector<double> errors;
  for (const CalibrationView& v : views) {
    if (v.used) errors.push_back(v.rms_px);
  }
  if (static_cast<int>(errors.size()) <= options.min_views) return false;
  std::sort(errors.begin(), errors.end());
  const double limit = options.outlier_ratio * std::max(errors[errors.size() / 2], 0.02);
  if (errors.back() <= limit) return false;
  for (CalibrationView& v : views) {
    if (!v.used || v.rms_px < errors.back()) continue;
    v.used = false;
    v.reason = fmt::format("error {:.3f} px is above {:.3f} px, {} times the median", v.rms_px,
                           limit, options.outlier_ratio);
  }
  return true;
}

CameraCalibration ToCamera(const Fit& fit, cv::Size size, const CameraCalibrationOptions& options) {
  CameraCalibration c;
  c.width_px = size.width;
  c.height_px = size.height;
  c.fu_px = fit.K.at<double>(0, 0);
  c.fv_px = fit.K.at<double>(1, 1);
  c.cu_px = fit.K.at<double>(0, 2);
  c.cv_px = fit.K.at<double>(1, 2);
  c.distortion = options.distortion;
  c.distortion_coefficients.clear();
  for (int i = 0; i < TermsOf(options); ++i) {
    c.distortion_coefficients.push_back(fit.distortion.at<double>(i));
  }
  return c;
}

CameraCalibrationResult TooFew(CameraCalibrationResult result, int min_views) {
  result.status = CameraCalibrationStatus::kTooFewViews;
  result.message =
      fmt::format("{} usable views, at least {} are needed", CountUsed(result.views), min_views);
  return result;
}

}  // namespace

CameraCalibrationResult CalibrateCamera(const std::vector<CalibrationImage>& images,
                                        const BoardSpec& board,
                                        const CameraCalibrationOptions& options) {
  if (board.kind != BoardKind::kChessboard) {
    throw InputError("charuco and aprilgrid boards are not supported yet, only chessboard");
  }
  CheckImages(images);
  const int flags = Flags(options);
  const cv::Size size(images.front().image.width_px, images.front().image.height_px);
  CameraCalibrationResult result;
  result.views = FindBoards(images, board);
  std::optional<Fit> fit;
  do {
    result.views_used = CountUsed(result.views);
    result.views_rejected = static_cast<int>(images.size()) - result.views_used;
    if (result.views_used < options.min_views) return TooFew(result, options.min_views);
    fit = FitUsedViews(result.views, board, size, flags);
    if (!fit) {
      result.status = CameraCalibrationStatus::kNotConverged;
      result.message = "the views do not determine the camera (are they all alike?)";
      return result;
    }
    FillViews(*fit, result.views);
  } while (RejectWorst(options, result.views));

  result.camera = ToCamera(*fit, size, options);
  for (int i = 0; i < 4 + TermsOf(options); ++i) {
    result.standard_deviations.push_back(fit->intrinsic_deviations.at<double>(i));
  }
  result.rms_reprojection_error_px = fit->rms_px;
  result.status = CameraCalibrationStatus::kOk;
  return result;
}

}  // namespace flextip
