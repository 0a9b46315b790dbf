// flextip calibrate camera: intrinsics from pictures of a board.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/camera/lens_options.h"
#include "apps/calibrate/camera/output.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "calibration/boards/board_pictures.h"
#include "core/error.h"
#include "recording/frames/frame_source.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct CalibrateCameraOptions {
  std::vector<fs::path> images;
  LensOptions lens;
  fs::path corners;
  bool force = false;
  fs::path out;
};

std::string WhyNot(const CameraCalibrationResult& result) {
  std::string message = fmt::format("calibrate camera: {}", result.message);
  for (const CalibrationView& v : result.views) {
    if (v.used) continue;
    return message + fmt::format("; {}: {}", v.name, v.reason);  // the first says what is wrong
  }
  return message;
}

void RunCalibrateCamera(const CalibrateCameraOptions& options, bool quiet) {
  OutputFolder output(options.out, "calibrate camera",
                      {.force = options.force, .inputs = options.images});
  const CornersFile corners =
      CornersOf({PictureFiles(options.images), options.lens.board, options.corners},
                ProgressFunction("images", quiet));
  const JudgedCamera judged = CalibrateAndJudge(corners, options.lens.Calibration());
  const CameraCalibrationResult& result = judged.result;
  if (!result.IsUsable()) throw WorkError(WhyNot(result));
  WriteCameraResults(output, corners, judged);
  if (quiet) return;
  fmt::print("{} views used, {} rejected, {} outliers among {} corners\n", result.views_used,
             result.views_rejected, result.solution.Outliers(),
             result.solution.CornersUsed() + result.solution.Outliers());
  fmt::print("reprojection error {:.4f} px RMS, {:.4f} px on held-out views\n",
             result.solution.RmsPx(), result.heldout_rms_px);
  fmt::print("{}\n", (options.out / "cam0" / "sensor.yaml").string());
}

}  // namespace

void AddCalibrateCamera(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand("camera", "Intrinsics from pictures of a board");
  auto options = std::make_shared<CalibrateCameraOptions>();
  command
      ->add_option("images", options->images,
                   "PNG or JPEG files, all of one size; a folder stands for those in it")
      ->type_name("IMAGE");
  AddLensOptions(*command, options->lens);
  command
      ->add_option("--corners", options->corners,
                   "Detected corners: read where the file exists, else written")
      ->type_name("FILE");
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n"
      "  flextip calibrate camera left*.jpg --board chessboard:9x6:0.025 -o left\n");
  OnRun(*command, context, [options, &context] { RunCalibrateCamera(*options, context.quiet); });
}

}  // namespace flextip
