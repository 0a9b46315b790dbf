#include "apps/calibrate/camera/output.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/budget/uncertainty.h"
#include "apps/calibrate/camera/board_shape_output.h"
#include "apps/calibrate/camera/pictures.h"
#include "apps/calibrate/camera/verdict.h"
#include "calibration/camera/choice.h"
#include "calibration/camera/split.h"
#include "core/error.h"
#include "recording/calibrations/file.h"
#include "recording/cameras/camera_file.h"
#include "report/pages.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::pair<std::string, double>> NamedIntrinsics(const CameraCalibration& c) {
  std::vector<std::pair<std::string, double>> named = {
      {"fu_px", c.fu_px}, {"fv_px", c.fv_px}, {"cu_px", c.cu_px}, {"cv_px", c.cv_px}};
  const bool fisheye = c.distortion == Distortion::kEquidistant;
  const std::vector<std::string> names =
      fisheye ? std::vector<std::string>{"k1", "k2", "k3", "k4"}
              : std::vector<std::string>{"k1", "k2", "p1", "p2", "k3", "k4",
                                         "k5", "k6", "s1", "s2", "s3", "s4"};
  for (std::size_t i = 0; i < c.distortion_coefficients.size(); ++i) {
    named.emplace_back(names[i], c.distortion_coefficients[i]);
  }
  return named;
}

json ParametersJson(const CameraCalibrationResult& r) {
  json parameters = json::array();
  const auto named = NamedIntrinsics(r.solution.camera);
  const auto sd = r.StandardDeviations();
  for (std::size_t i = 0; i < named.size(); ++i) {
    parameters.push_back(
        {{"parameter", named[i].first}, {"value", named[i].second}, {"standard_deviation", sd[i]}});
  }
  return parameters;
}

json ViewsJson(const CameraCalibrationResult& result) {
  json views = json::array();
  for (const CalibrationView& v : result.views) {
    views.push_back(
        {{"image", v.name}, {"used", v.used}, {"rms_px", nullptr}, {"reason", v.reason}});
  }
  for (const SolvedView& v : result.solution.views) {
    json& view = views[v.index];
    view["rms_px"] = v.RmsPx();
    view["corners"] = v.px.size();
    view["outliers"] = static_cast<int>(v.px.size()) - v.CountUsed();
  }
  return views;
}

json CandidatesJson(const CameraCalibrationResult& result) {
  json candidates = json::array();
  for (const LensCandidate& c : result.candidates) {
    json one = {{"lens", c.model.Name()}, {"chosen", c.chosen}, {"reason", c.reason}};
    if (c.heldout) {
      one["heldout_rms_px"] = c.heldout->rms_px;
      one["rms_px"] = c.solution.RmsPx();
      one["fu_px"] = c.solution.camera.fu_px;
    }
    candidates.push_back(one);
  }
  return candidates;
}

json WarpJson(const CameraCalibrationResult& r) {
  json warp = {{"estimated", r.solution.warp_estimated}, {"reason", r.warp_reason}};
  if (!r.solution.warp_estimated) return warp;
  const int at = r.solution.IntrinsicsCount();
  for (int i = 0; i < 2; ++i) {
    const std::string axis = i == 0 ? "x" : "y";
    warp["bulge_" + axis + "_m"] = r.solution.warp.bulge_m[i];
    warp["bulge_" + axis + "_sd_m"] = std::sqrt(r.covariance(at + i, at + i));
  }
  return warp;
}

json Summary(const CameraCalibrationResult& r) {
  const CameraCalibration& c = r.solution.camera;
  json summary = {
      {"rms_reprojection_error_px", r.solution.RmsPx()},
      {"heldout_error_px", r.heldout_rms_px},
      {"views_used", r.views_used},
      {"views_rejected", r.views_rejected},
      {"corners_used", r.solution.CornersUsed()},
      {"outliers", r.solution.Outliers()},
      {"rms_with_outliers_px", r.solution.RmsPx(true)},
      {"noise_px", r.solution.noise_px},
      {"lens", LensModel{c.distortion, static_cast<int>(c.distortion_coefficients.size())}.Name()},
      {"parameters", ParametersJson(r)},
      {"lens_candidates", CandidatesJson(r)},
      {"board_warp", WarpJson(r)},
      {"views", ViewsJson(r)}};
  summary["board_shape"] = BoardShapeJson(r.solution.shape, r.shape_reason);
  if (const auto split = SplitViews(r.solution)) {
    summary["split_views_rms_px"] = split->rms_px;
    summary["split_views_max_px"] = split->max_px;
  }
  return summary;
}

// Intrinsics and coefficients with their covariance, in the order of Calibration::CoordinateNames.
Calibration ToCalibration(const CameraCalibrationResult& r) {
  Calibration calibration;
  calibration.kind = "camera";
  AddLens("cam0", r.solution.camera, calibration);
  const int n = r.solution.IntrinsicsCount(), terms = n - 4;
  calibration.covariance.resize(n, n);
  calibration.covariance << r.covariance.block(4, 4, terms, terms),
      r.covariance.block(4, 0, terms, 4), r.covariance.block(0, 4, 4, terms),
      r.covariance.topLeftCorner(4, 4);
  return calibration;
}

void WriteText(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw WorkError(fmt::format("{}: cannot be written", file.string()));
}

std::string ResidualTable(const CameraSolution& s) {
  std::string text = "#image,id [],x [px],y [px],dx [px],dy [px],used []\n";
  for (const SolvedView& v : s.views) {
    for (std::size_t i = 0; i < v.px.size(); ++i) {
      text += fmt::format("{},{},{:.4f},{:.4f},{:.4f},{:.4f},{}\n",
                          fs::path(v.name).filename().string(), v.ids[i], v.px[i].x(), v.px[i].y(),
                          v.residual_px[i].x(), v.residual_px[i].y(), v.IsUsed(i) ? 1 : 0);
    }
  }
  return text;
}

}  // namespace

void WriteCameraResults(OutputFolder& output, const CornersFile& corners,
                        const CameraCalibrationResult& result) {
  const fs::path& folder = output.folder();
  WriteCameraCalibration(folder / "cam0" / "sensor.yaml", result.solution.camera,
                         fmt::format("calibrated from {}", corners.board));
  WriteCalibration(folder / "calibration.yaml", ToCalibration(result));
  WriteText(folder / "residuals.csv", ResidualTable(result.solution));
  for (const CalibrationView& view : result.views) {
    if (!view.used) output.Warn(fmt::format("{}: {}", view.name, view.reason));
  }
  const std::string folds = FoldsInPicture(result.solution.camera);
  if (!folds.empty())
    output.Warn(fmt::format("the lens holds only where boards were seen: {}", folds));
  DrawCameraPictures(folder, corners, result);
  json summary = Summary(result);
  const auto x_B = BoardCorners(ParseBoardSpec(corners.board));
  std::vector<report::Figure> figures;
  AddUncertainty(folder, result.solution, x_B, summary, figures);
  AddBoardFigure(x_B, result.solution.warp, result.solution.shape, figures);
  report::WriteFigures(folder / "figures.json", figures);
  summary["verdict"] = VerdictJson(CameraVerdict(result, summary));
  output.WriteSummary(summary);
  report::WriteCalibrateReport(folder);
  output.Commit();
}

}  // namespace flextip
