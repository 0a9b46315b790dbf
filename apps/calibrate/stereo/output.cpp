#include "apps/calibrate/stereo/output.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/calibrate/camera/board_shape_output.h"
#include "apps/calibrate/camera/uncertainty_output.h"
#include "apps/calibrate/verdict_json.h"
#include "calibration/boards/board.h"
#include "calibration/entries.h"
#include "calibration/stereo/rectification_text.h"
#include "recording/cameras/camera_file.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/pages.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json PoseJson(const StereoResult& r) {
  const Pose& T = r.solution.T_C0C1;
  const Eigen::Quaterniond q = T.Quaternion();
  const Eigen::VectorXd sd = r.PairCovariance().diagonal().cwiseSqrt();
  return {{"p_C0C1_m", {T.p.x(), T.p.y(), T.p.z()}},
          {"p_C0C1_sd_m", {sd[3], sd[4], sd[5]}},
          {"q_C0C1", {q.w(), q.x(), q.y(), q.z()}},
          {"turn_sd_rad", {sd[0], sd[1], sd[2]}}};
}

Json PairsJson(const StereoResult& r) {
  Json pairs = Json::array();
  for (const StereoPairResult& pair : r.pairs) {
    pairs.push_back({{"left", pair.names[0]},
                     {"right", pair.names[1]},
                     {"left_rms_px", nullptr},
                     {"right_rms_px", nullptr},
                     {"left_reason", pair.reasons[0]},
                     {"right_reason", pair.reasons[1]},
                     {"apart", pair.apart}});
  }
  for (const StereoView& view : r.solution.views) {
    for (int eye = 0; eye < 2; ++eye) {
      if (view.eyes[eye].px.empty()) continue;
      pairs[view.index][eye == 0 ? "left_rms_px" : "right_rms_px"] = view.eyes[eye].RmsPx();
    }
  }
  return pairs;
}

Json EyeJson(const JudgedStereo& judged, int eye) {
  const StereoResult& r = judged.result;
  const CameraCalibration& c = r.solution.cameras[eye];
  const int first = eye == 0 ? 0 : r.solution.IntrinsicsCount(0);
  std::vector<double> sd(4);
  for (int i = 0; i < 4; ++i) sd[i] = std::sqrt(r.covariance(first + i, first + i));
  Json json_of_eye = {{"lens", LensModelOf(c).Name()},
                      {"rms_reprojection_error_px", r.solution.RmsPx(eye)},
                      {"rms_alone_px", r.alone[eye].solution.RmsPx()},
                      {"heldout_alone_px", r.alone[eye].heldout_rms_px},
                      {"intrinsics_px", {c.fu_px, c.fv_px, c.cu_px, c.cv_px}},
                      {"intrinsics_sd_px", sd}};
  if (judged.uncertainty[eye]) {
    json_of_eye["projection_uncertainty"] = UncertaintyJson(*judged.uncertainty[eye]);
  }
  return json_of_eye;
}

Json Summary(const JudgedStereo& judged) {
  const StereoResult& r = judged.result;
  Json summary = {{"rms_reprojection_error_px", r.solution.RmsPx()},
                  {"noise_px", r.solution.noise_px},
                  {"pairs_used", r.pairs_used},
                  {"single_views_used", r.single_views_used},
                  {"corners_used", r.solution.CornersUsed()},
                  {"baseline_m", r.baseline.length_m},
                  {"baseline_sd_m", r.baseline.sd_m},
                  {"board_shape", BoardShapeJson(r.solution.shape, r.shape_reason)},
                  {"extrinsics", PoseJson(r)},
                  {"epipolar_rms_px", r.epipolar_rms_px},
                  {"cam0", EyeJson(judged, 0)},
                  {"cam1", EyeJson(judged, 1)},
                  {"pairs", PairsJson(r)},
                  {"verdict", VerdictJson(judged.verdict)}};
  if (r.heldout) {
    summary["heldout"] = {{"rms_px", r.heldout->rms_px},
                          {"epipolar_rms_px", r.heldout->epipolar_rms_px},
                          {"length_rms_mm", 1e3 * r.heldout->length_rms_m},
                          {"length_mean_mm", 1e3 * r.heldout->length_mean_m}};
  }
  return summary;
}

std::string ResidualTable(const StereoSolution& s) {
  CsvWriter csv(
      {"image", "camera []", "id []", "x [px]", "y [px]", "dx [px]", "dy [px]", "used []"});
  for (const StereoView& view : s.views) {
    for (int eye = 0; eye < 2; ++eye) {
      const SolvedView& v = view.eyes[eye];
      const std::string name = fs::path(v.name).filename().string();
      for (std::size_t i = 0; i < v.px.size(); ++i) {
        csv.Add(name).Add(TimeNs{eye}).Add(TimeNs{v.ids[i]});
        csv.AddFixed(v.px[i].x(), 4).AddFixed(v.px[i].y(), 4);
        csv.AddFixed(v.residual_px[i].x(), 4).AddFixed(v.residual_px[i].y(), 4);
        csv.Add(TimeNs{v.IsUsed(i)}).EndRow();
      }
    }
  }
  return csv.text();
}

report::Figure PairFigure(const StereoResult& r) {
  report::Figure figure;
  figure.name = "stereo-pairs";
  figure.title = "Error of each picture";
  figure.x_label = "pair";
  figure.y_label = "RMS distance of the corners used (px)";
  for (int eye = 0; eye < 2; ++eye) {
    report::FigureTrace bars;
    bars.name = eye == 0 ? "left" : "right";
    bars.kind = report::FigureTrace::Kind::kBars;
    for (const StereoView& view : r.solution.views) {
      if (view.eyes[eye].px.empty()) continue;
      bars.x.push_back(static_cast<double>(view.index));
      bars.y.push_back(view.eyes[eye].RmsPx());
    }
    figure.traces.push_back(bars);
  }
  return figure;
}

void WriteCameras(const fs::path& folder, const StereoResult& r, const std::string& board,
                  const Pose& T_RC0) {
  const std::array<Pose, 2> T_RC = {T_RC0, T_RC0 * r.solution.T_C0C1};
  const Rectification rectification = Rectify(r.solution.cameras, r.solution.T_C0C1);
  for (int eye = 0; eye < 2; ++eye) {
    CameraCalibration camera = r.solution.cameras[eye];
    camera.T_RC = T_RC[eye];
    const std::string name = fmt::format("cam{}", eye);
    WriteCameraCalibration(folder / name / "sensor.yaml", camera,
                           fmt::format("calibrated as a stereo pair from {}", board));
    const std::string ros = RosCameraInfoText(name, eye, camera, rectification);
    if (!ros.empty()) WriteTextFile(folder / "ros" / (name + "_camera_info.yaml"), ros);
  }
  WriteTextFile(folder / "opencv_stereo.yml",
                OpenCvStereoText(r.solution.cameras, r.solution.T_C0C1, rectification));
}

}  // namespace

void WriteStereoResults(OutputFolder& output, const JudgedStereo& judged, const std::string& board,
                        const Pose& T_RC0) {
  const fs::path& folder = output.folder();
  const StereoResult& result = judged.result;
  WriteCameras(folder, result, board, T_RC0);
  WriteCalibration(folder / "calibration.yaml", StereoEntries(result));
  WriteTextFile(folder / "residuals.csv", ResidualTable(result.solution));
  std::vector<report::Figure> figures = {PairFigure(result)};
  for (int eye = 0; eye < 2; ++eye) {
    if (!judged.uncertainty[eye]) continue;
    std::vector<SolvedView> views;
    for (const StereoView& view : result.solution.views) views.push_back(view.eyes[eye]);
    WriteUncertainty(folder, fmt::format("cam{}", eye), *judged.uncertainty[eye], views, figures);
  }
  AddBoardFigure(BoardCorners(ParseBoardSpec(board)), result.solution.warp, result.solution.shape,
                 figures);
  report::WriteFigures(folder / "figures.json", figures);
  for (const StereoPairResult& pair : result.pairs) {
    for (int eye = 0; eye < 2; ++eye) {
      if (pair.reasons[eye].empty() || pair.names[eye].empty()) continue;
      output.Warn(fmt::format("{}: {}", pair.names[eye], pair.reasons[eye]));
    }
    if (!pair.apart.empty()) output.Warn(fmt::format("{}: {}", pair.names[0], pair.apart));
  }
  output.WriteSummary(Summary(judged));
  report::WriteCalibrateReport(folder);
  output.Commit();
}

}  // namespace flextip
