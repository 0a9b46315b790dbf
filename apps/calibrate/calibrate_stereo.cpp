// flextip calibrate stereo: two cameras fixed to each other, from pictures of a board.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/calibrate_stereo_output.h"
#include "apps/frames.h"
#include "apps/output.h"
#include "apps/progress.h"
#include "core/error.h"
#include "recording/camera_file.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct CalibrateStereoOptions {
  std::vector<fs::path> left, right;
  std::string board, distortion = "auto", warp = "auto";
  int terms = 5;
  fs::path pose;
  bool force = false;
  fs::path out;
};

StereoOptions CalibrationOptions(const CalibrateStereoOptions& o) {
  StereoOptions options;
  auto& lens = options.camera.lens;
  if (o.distortion == "radial-tangential") lens = {Distortion::kRadialTangential, 4};
  if (o.distortion == "equidistant") lens = {Distortion::kEquidistant, 4};
  if (o.distortion == "opencv") lens = {Distortion::kOpenCv, o.terms};
  if (o.warp != "auto") options.camera.warp = o.warp == "on";
  return options;
}

// The board in one eye's picture; all of an eye's pictures have the size of its first.
BoardView Detect(const fs::path& file, const BoardSpec& board, Eigen::Vector2i& size_px) {
  const Image image = ReadImageFile(file);
  const Eigen::Vector2i size(image.width_px, image.height_px);
  if (size_px.isZero()) size_px = size;
  if (size != size_px) {
    throw InputError::At(file.string(), 0,
                         fmt::format("expected {}x{} pixels as in the first, found {}x{}",
                                     size_px.x(), size_px.y(), size.x(), size.y()));
  }
  return {file.string(), DetectBoard(image, board)};
}

void RunCalibrateStereo(const CalibrateStereoOptions& options, bool quiet) {
  if (options.left.size() != options.right.size()) {
    throw InputError(fmt::format(
        "calibrate stereo: {} left and {} right pictures; they are paired in their order",
        options.left.size(), options.right.size()));
  }
  const BoardSpec board = ParseBoardSpec(options.board);
  Pose T_RC0;
  if (!options.pose.empty()) T_RC0 = ReadCameraCalibration(options.pose).T_RC;
  std::vector<fs::path> inputs = options.left;
  inputs.insert(inputs.end(), options.right.begin(), options.right.end());
  OutputFolder output(options.out, "calibrate stereo", {.force = options.force, .inputs = inputs});
  std::vector<StereoPair> pairs;
  std::array<Eigen::Vector2i, 2> sizes_px = {Eigen::Vector2i::Zero(), Eigen::Vector2i::Zero()};
  {
    Progress progress("pairs", options.left.size(), quiet);
    for (std::size_t i = 0; i < options.left.size(); ++i) {
      pairs.push_back({{Detect(options.left[i], board, sizes_px[0]),
                        Detect(options.right[i], board, sizes_px[1])}});
      progress.Update(pairs.size());
    }
  }
  const StereoResult result = CalibrateStereo(pairs, sizes_px, board, CalibrationOptions(options));
  if (!result.IsUsable()) throw WorkError(fmt::format("calibrate stereo: {}", result.message));
  WriteStereoResults(output, result, options.board, T_RC0);
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
  command->add_option("left", options->left, "Pictures of camera 0, in order")
      ->required()
      ->type_name("IMAGE");
  command->add_option("--right", options->right, "Of camera 1, at the same moments")
      ->required()
      ->type_name("IMAGE");
  command->add_option("--board", options->board, "As in calibrate camera")
      ->required()
      ->type_name("SPEC");
  command
      ->add_option("--distortion", options->distortion,
                   "auto (by the error of held-out views), radial-tangential, opencv, equidistant")
      ->check(CLI::IsMember({"auto", "radial-tangential", "opencv", "equidistant"}))
      ->capture_default_str();
  command->add_option("--terms", options->terms, "Terms of the opencv model")
      ->check(CLI::IsMember({5, 8, 12}))
      ->capture_default_str();
  command->add_option("--warp", options->warp, "Whether the board may be bent: auto, on or off")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
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
