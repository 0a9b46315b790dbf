// flextip calibrate camera: intrinsics from pictures of a board.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate.h"
#include "apps/frames.h"
#include "apps/output.h"
#include "apps/overlay.h"
#include "apps/progress.h"
#include "calibration/camera_calibration.h"
#include "core/error.h"
#include "recording/camera_file.h"
#include "report/pages.h"

namespace flextip {
namespace {

struct CalibrateCameraOptions {
  std::vector<std::filesystem::path> images;
  std::string board;
  std::string distortion = "opencv";
  int terms = 5;
  bool force = false;
  std::filesystem::path out;
};

BoardSpec SupportedBoard(const std::string& spec) {
  const BoardSpec board = ParseBoardSpec(spec);
  if (board.kind != BoardKind::kChessboard) {
    throw InputError(fmt::format("board '{}': not supported yet, only chessboard", spec));
  }
  return board;
}

nlohmann::json ViewsJson(const CameraCalibrationResult& result) {
  nlohmann::json views = nlohmann::json::array();
  for (const CalibrationView& v : result.views) {
    nlohmann::json view = {{"image", v.name}, {"used", v.used}};
    view["rms_px"] = v.used ? nlohmann::json(v.rms_px) : nlohmann::json(nullptr);
    view["reason"] = v.reason;
    views.push_back(view);
  }
  return views;
}

nlohmann::json Summary(const CameraCalibrationResult& r) {
  nlohmann::json parameters = nlohmann::json::array();
  const CameraCalibration& c = r.camera;
  std::vector<std::pair<std::string, double>> named = {
      {"fu_px", c.fu_px}, {"fv_px", c.fv_px}, {"cu_px", c.cu_px}, {"cv_px", c.cv_px}};
  const char* distortion_names[] = {"k1", "k2", "p1", "p2", "k3", "k4",
                                    "k5", "k6", "s1", "s2", "s3", "s4"};
  for (std::size_t i = 0; i < c.distortion_coefficients.size(); ++i) {
    named.emplace_back(distortion_names[i], c.distortion_coefficients[i]);
  }
  for (std::size_t i = 0; i < named.size(); ++i) {
    parameters.push_back({{"parameter", named[i].first},
                          {"value", named[i].second},
                          {"standard_deviation", r.standard_deviations[i]}});
  }
  return {{"rms_reprojection_error_px", r.rms_reprojection_error_px},
          {"views_used", r.views_used},
          {"views_rejected", r.views_rejected},
          {"parameters", parameters},
          {"views", ViewsJson(r)}};
}

void WriteResults(OutputFolder& output, const std::vector<CalibrationImage>& images,
                  const CameraCalibrationResult& result) {
  WriteCameraCalibration(output.folder() / "cam0" / "sensor.yaml", result.camera,
                         "calibrated from a chessboard");
  for (std::size_t i = 0; i < images.size(); ++i) {
    const CalibrationView& view = result.views[i];
    Image image = images[i].image;
    DrawPoints(image, view.corners_px);
    DrawLabel(image, view.used ? fmt::format("{:.3f} px", view.rms_px) : view.reason);
    const std::string stem = std::filesystem::path(view.name).stem().string();
    WritePng(output.folder() / "overlay" / fmt::format("{:04}_{}.png", i, stem), image);
    if (!view.used) output.Warn(fmt::format("{}: {}", view.name, view.reason));
  }
  output.WriteSummary(Summary(result));
  WriteCalibrateReport(output.folder());
  output.Commit();
}

void RunCalibrateCamera(const CalibrateCameraOptions& options, bool quiet) {
  const BoardSpec board = SupportedBoard(options.board);
  CameraCalibrationOptions calibration;
  calibration.distortion = options.distortion == "radial-tangential" ? Distortion::kRadialTangential
                                                                     : Distortion::kOpenCv;
  calibration.distortion_terms = options.terms;
  OutputFolder output(options.out, "calibrate camera",
                      {.force = options.force, .inputs = options.images});
  std::vector<CalibrationImage> images;
  {
    Progress progress("images", options.images.size(), quiet);
    for (const auto& file : options.images) {
      images.push_back({file.string(), ReadImageFile(file)});
      progress.Update(images.size());
    }
  }
  const CameraCalibrationResult result = CalibrateCamera(images, board, calibration);
  if (!result.IsUsable()) {
    std::string message = fmt::format("calibrate camera: {}", result.message);
    for (const CalibrationView& v : result.views) {
      if (v.used) continue;
      message += fmt::format("; {}: {}", v.name, v.reason);
      break;  // one line; the first says what is wrong
    }
    throw WorkError(message);
  }
  WriteResults(output, images, result);
  if (quiet) return;
  fmt::print("{} views used, {} rejected, reprojection error {:.4f} px RMS\n", result.views_used,
             result.views_rejected, result.rms_reprojection_error_px);
  fmt::print("{}\n", (options.out / "cam0" / "sensor.yaml").string());
}

}  // namespace

void AddCalibrateCamera(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand("camera", "Intrinsics from pictures of a board");
  auto options = std::make_shared<CalibrateCameraOptions>();
  command->add_option("images", options->images, "PNG or JPEG files, all of one size")
      ->required()
      ->type_name("IMAGE");
  command->add_option("--board", options->board, "chessboard:COLSxROWS:SQUARE_M (inner corners)")
      ->required()
      ->type_name("SPEC");
  command->add_option("--distortion", options->distortion, "opencv or radial-tangential")
      ->check(CLI::IsMember({"opencv", "radial-tangential"}))
      ->capture_default_str();
  command->add_option("--terms", options->terms, "Terms of the opencv model")
      ->check(CLI::IsMember({5, 8, 12}))
      ->capture_default_str();
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n"
      "  flextip calibrate camera left*.jpg --board chessboard:9x6:0.025 -o left\n");
  OnRun(*command, context, [options, &context] { RunCalibrateCamera(*options, context.quiet); });
}

}  // namespace flextip
