#include "apps/calibrate/camera/output.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/camera/board_shape_output.h"
#include "apps/calibrate/camera/corner_figures.h"
#include "apps/calibrate/camera/pictures.h"
#include "apps/calibrate/camera/uncertainty_output.h"
#include "apps/calibrate/verdict_json.h"
#include "calibration/camera/choice.h"
#include "calibration/entries.h"
#include "recording/cameras/camera_file.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

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

Json ParametersJson(const CameraCalibrationResult& r) {
  Json parameters = Json::array();
  const auto named = NamedIntrinsics(r.solution.camera);
  const auto sd = r.StandardDeviations();
  for (std::size_t i = 0; i < named.size(); ++i) {
    parameters.push_back(
        {{"parameter", named[i].first}, {"value", named[i].second}, {"standard_deviation", sd[i]}});
  }
  return parameters;
}

Json ViewsJson(const CameraCalibrationResult& result) {
  Json views = Json::array();
  for (const CalibrationView& v : result.views) {
    views.push_back(
        {{"image", v.name}, {"used", v.used}, {"rms_px", nullptr}, {"reason", v.reason}});
  }
  for (const SolvedView& v : result.solution.views) {
    Json& view = views[v.index];
    view["rms_px"] = v.RmsPx();
    view["corners"] = v.px.size();
    view["outliers"] = static_cast<int>(v.px.size()) - v.CountUsed();
  }
  return views;
}

Json CandidatesJson(const CameraCalibrationResult& result) {
  Json candidates = Json::array();
  for (const LensCandidate& c : result.candidates) {
    Json one = {{"lens", c.model.Name()}, {"chosen", c.chosen}, {"reason", c.reason}};
    if (c.heldout) {
      one["heldout_rms_px"] = c.heldout->rms_px;
      one["rms_px"] = c.solution.RmsPx();
      one["fu_px"] = c.solution.camera.fu_px;
    }
    candidates.push_back(one);
  }
  return candidates;
}

Json WarpJson(const CameraCalibrationResult& r) {
  Json warp = {{"estimated", r.solution.warp_estimated}, {"reason", r.warp_reason}};
  if (!r.solution.warp_estimated) return warp;
  const int at = r.solution.IntrinsicsCount();
  for (int i = 0; i < 2; ++i) {
    const std::string axis = i == 0 ? "x" : "y";
    warp["bulge_" + axis + "_m"] = r.solution.warp.bulge_m[i];
    warp["bulge_" + axis + "_sd_m"] = std::sqrt(r.covariance(at + i, at + i));
  }
  return warp;
}

Json Summary(const JudgedCamera& judged) {
  const CameraCalibrationResult& r = judged.result;
  const CameraCalibration& c = r.solution.camera;
  Json summary = {{"rms_reprojection_error_px", r.solution.RmsPx()},
                  {"heldout_error_px", r.heldout_rms_px},
                  {"views_used", r.views_used},
                  {"views_rejected", r.views_rejected},
                  {"corners_used", r.solution.CornersUsed()},
                  {"outliers", r.solution.Outliers()},
                  {"rms_with_outliers_px", r.solution.RmsPx(true)},
                  {"noise_px", r.solution.noise_px},
                  {"lens", LensModelOf(c).Name()},
                  {"parameters", ParametersJson(r)},
                  {"lens_candidates", CandidatesJson(r)},
                  {"board_warp", WarpJson(r)},
                  {"views", ViewsJson(r)}};
  summary["board_shape"] = BoardShapeJson(r.solution.shape, r.shape_reason);
  if (judged.split) {
    summary["split_views_rms_px"] = judged.split->rms_px;
    summary["split_views_max_px"] = judged.split->max_px;
  }
  if (judged.uncertainty) summary["projection_uncertainty"] = UncertaintyJson(*judged.uncertainty);
  summary["verdict"] = VerdictJson(judged.verdict);
  return summary;
}

std::string ResidualTable(const CameraSolution& s) {
  CsvWriter csv({"image", "id []", "x [px]", "y [px]", "dx [px]", "dy [px]", "used []"});
  for (const SolvedView& v : s.views) {
    const std::string name = fs::path(v.name).filename().string();
    for (std::size_t i = 0; i < v.px.size(); ++i) {
      csv.Add(name).Add(TimeNs{v.ids[i]});
      csv.AddFixed(v.px[i].x(), 4).AddFixed(v.px[i].y(), 4);
      csv.AddFixed(v.residual_px[i].x(), 4).AddFixed(v.residual_px[i].y(), 4);
      csv.Add(TimeNs{v.IsUsed(i)}).EndRow();
    }
  }
  return csv.text();
}

}  // namespace

void WriteCameraResults(OutputFolder& output, const CornersFile& corners,
                        const JudgedCamera& judged) {
  const fs::path& folder = output.folder();
  const CameraCalibrationResult& result = judged.result;
  WriteCameraCalibration(folder / "cam0" / "sensor.yaml", result.solution.camera,
                         fmt::format("calibrated from {}", corners.board));
  WriteCalibration(folder / "calibration.yaml", CameraEntries(result));
  WriteTextFile(folder / "residuals.csv", ResidualTable(result.solution));
  for (const CalibrationView& view : result.views) {
    if (!view.used) output.Warn(fmt::format("{}: {}", view.name, view.reason));
  }
  const std::string folds = FoldsInPicture(result.solution.camera);
  if (!folds.empty()) {
    output.Warn(fmt::format("the lens holds only where boards were seen: {}", folds));
  }
  DrawCameraPictures(folder, corners, result);
  std::vector<report::Figure> figures{ResidualsFigure(corners, result.solution),
                                      CoverageFigure(corners, result.solution)};
  if (judged.uncertainty) {
    WriteUncertainty(folder, "cam0", *judged.uncertainty, result.solution.views, figures);
  }
  AddBoardFigure(BoardCorners(ParseBoardSpec(corners.board)), result.solution.warp,
                 result.solution.shape, figures);
  report::WriteFigures(folder / "figures.json", figures);
  output.WriteSummary(Summary(judged));
  report::WriteCalibrateReport(folder);
  output.Commit();
}

}  // namespace flextip
