// flextip calibrate stereo: two cameras fixed to each other, from pictures of a board.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/camera/lens_options.h"
#include "apps/calibrate/stereo/output.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "calibration/boards/board_pictures.h"
#include "core/error.h"
#include "recording/cameras/camera_file.h"
#include "recording/frames/frame_source.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct CalibrateStereoOptions {
  std::vector<fs::path> left, right;
  LensOptions lens;
  std::vector<fs::path> corners;  // none, or of the left and the right camera
  fs::path pose;
  bool force = false;
  fs::path out;
};

void RequireAsMany(std::size_t left, std::size_t right) {
  if (left == right) return;
  throw InputError(
      fmt::format("calibrate stereo: {} left and {} right pictures; they are paired in their order",
                  left, right));
}

void RunCalibrateStereo(const CalibrateStereoOptions& options, bool quiet) {
  // Named on neither side: all that the corners' files have.
  const std::array<std::vector<fs::path>, 2> images{PictureFiles(options.left),
                                                    PictureFiles(options.right)};
  if (options.corners.empty()) RequireAsMany(images[0].size(), images[1].size());
  Pose T_RC0;
  if (!options.pose.empty()) T_RC0 = ReadCameraCalibration(options.pose).T_RC;
  std::vector<fs::path> inputs = options.left;
  inputs.insert(inputs.end(), options.right.begin(), options.right.end());
  OutputFolder output(options.out, "calibrate stereo", {.force = options.force, .inputs = inputs});
  std::array<CornersFile, 2> eyes;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const fs::path corners = options.corners.empty() ? fs::path() : options.corners[eye];
    eyes[eye] =
        CornersOf({images[eye], options.lens.board, corners}, ProgressFunction("images", quiet));
  }
  RequireAsMany(eyes[0].views.size(), eyes[1].views.size());
  StereoOptions calibration;
  calibration.camera = options.lens.Calibration();
  const JudgedStereo judged = CalibrateAndJudge(eyes, calibration);
  const StereoResult& result = judged.result;
  if (!result.IsUsable()) throw WorkError(fmt::format("calibrate stereo: {}", result.message));
  WriteStereoResults(output, judged, options.lens.board, T_RC0);
  if (quiet) return;
  fmt::print("{} pairs and {} single views used, reprojection error {:.4f} px RMS\n",
             result.pairs_used, result.single_views_used, result.solution.RmsPx());
  if (result.heldout) {
    fmt::print("held-out pairs: {:.4f} px, rows {:.4f} px, lengths {:.4f} mm RMS\n",
               result.heldout->rms_px, result.heldout->epipolar_rms_px,
               1e3 * result.heldout->length_rms_m);
  }
  fmt::print("baseline {:.4f} mm, standard deviation {:.4f} mm\n", 1e3 * result.baseline.length_m,
             1e3 * result.baseline.sd_m);
}

}  // namespace

void AddCalibrateStereo(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand("stereo", "Two cameras fixed to each other");
  auto options = std::make_shared<CalibrateStereoOptions>();
  command
      ->add_option("left", options->left,
                   "Pictures of camera 0, in order; a folder stands for those in it")
      ->type_name("IMAGE");
  command->add_option("--right", options->right, "Of camera 1, at the same moments")
      ->type_name("IMAGE");
  AddLensOptions(*command, options->lens);
  command
      ->add_option("--corners", options->corners,
                   "Detected corners of the left and of the right camera: read where the file "
                   "exists, else written")
      ->expected(2)
      ->type_name("LEFT RIGHT");
  command->add_option("--pose", options->pose, "A sensor.yaml with camera 0's T_RC; else it is R")
      ->type_name("FILE");
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n"
      "  flextip calibrate stereo left*.jpg --right right*.jpg --board chessboard:9x6:0.025 -o "
      "stereo\n");
  OnRun(*command, context, [options, &context] { RunCalibrateStereo(*options, context.quiet); });
}

}  // namespace flextip
