// flextip calibrate camera: intrinsics from pictures of a board.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/calibrate_camera_output.h"
#include "apps/frames.h"
#include "apps/output.h"
#include "apps/progress.h"
#include "calibration/boards/corners_file.h"
#include "core/error.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct CalibrateCameraOptions {
  std::vector<fs::path> images;
  std::string board;
  std::string distortion = "auto";
  int terms = 5;
  std::string warp = "auto";
  std::optional<double> board_sd_m;
  fs::path corners;
  bool force = false;
  fs::path out;
};

CameraCalibrationOptions CalibrationOptions(const CalibrateCameraOptions& o) {
  CameraCalibrationOptions calibration;
  if (o.distortion == "radial-tangential") calibration.lens = {Distortion::kRadialTangential, 4};
  if (o.distortion == "equidistant") calibration.lens = {Distortion::kEquidistant, 4};
  if (o.distortion == "opencv") calibration.lens = {Distortion::kOpenCv, o.terms};
  if (o.warp != "auto") calibration.warp = o.warp == "on";
  calibration.board_sd_m = o.board_sd_m;
  return calibration;
}

Image ReadSized(const fs::path& file, const CornersFile& corners) {
  Image image = ReadImageFile(file);
  if (!corners.views.empty() &&
      (image.width_px != corners.width_px || image.height_px != corners.height_px)) {
    throw InputError::At(
        file.string(), 0,
        fmt::format("expected {}x{} pixels as in {}, found {}x{}", corners.width_px,
                    corners.height_px, corners.views[0].name, image.width_px, image.height_px));
  }
  return image;
}

// Pictures that did not tell a charuco board's layout, once others have.
void DetectAgain(const CalibrateCameraOptions& options, BoardSpec board, CornersFile& corners) {
  const auto telling =
      std::find_if(corners.views.begin(), corners.views.end(),
                   [](const BoardView& v) { return v.sighting.layout != CharucoLayout::kUnknown; });
  if (board.kind != BoardKind::kCharuco || telling == corners.views.end()) return;
  board.layout = telling->sighting.layout;
  for (std::size_t i = 0; i < corners.views.size(); ++i) {
    BoardSighting& seen = corners.views[i].sighting;
    if (seen.layout == board.layout) continue;
    seen = DetectBoard(ReadSized(options.images[i], corners), board);
  }
}

// Finds the board in every picture; only one picture is held at a time.
CornersFile Detect(const CalibrateCameraOptions& options, const BoardSpec& board, bool quiet) {
  if (options.images.empty()) throw InputError("calibrate camera: no images to find the board in");
  CornersFile corners{.board = options.board, .width_px = 0, .height_px = 0, .views = {}};
  Progress progress("images", options.images.size(), quiet);
  for (const fs::path& file : options.images) {
    const Image image = ReadSized(file, corners);
    corners.width_px = image.width_px;
    corners.height_px = image.height_px;
    corners.views.push_back({file.string(), DetectBoard(image, board)});
    progress.Update(corners.views.size());
  }
  DetectAgain(options, board, corners);
  return corners;
}

// What was detected before, of the images named, or of all where none is.
CornersFile Reload(const CalibrateCameraOptions& options) {
  CornersFile corners = ReadCorners(options.corners);
  if (corners.board != options.board) {
    throw InputError::At(
        options.corners.string(), 2,
        fmt::format("is of board '{}', not of '{}'", corners.board, options.board));
  }
  if (options.images.empty()) return corners;
  std::map<std::string, BoardView> by_name;
  for (const BoardView& view : corners.views) by_name[view.name] = view;
  corners.views.clear();
  for (const fs::path& image : options.images) {
    const auto it = by_name.find(image.string());
    if (it == by_name.end()) {
      throw InputError::At(options.corners.string(), 0,
                           fmt::format("has no image '{}'", image.string()));
    }
    corners.views.push_back(it->second);
  }
  return corners;
}

CornersFile Corners(const CalibrateCameraOptions& options, bool quiet) {
  const BoardSpec board = ParseBoardSpec(options.board);
  if (!options.corners.empty() && fs::exists(options.corners)) return Reload(options);
  const CornersFile corners = Detect(options, board, quiet);
  if (!options.corners.empty()) WriteCorners(options.corners, corners);
  return corners;
}

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
  const CornersFile corners = Corners(options, quiet);
  const CameraCalibrationResult result =
      CalibrateCamera(corners.views, corners.width_px, corners.height_px,
                      ParseBoardSpec(options.board), CalibrationOptions(options));
  if (!result.IsUsable()) throw WorkError(WhyNot(result));
  WriteCameraResults(output, corners, result);
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
  command->add_option("images", options->images, "PNG or JPEG files, all of one size")
      ->type_name("IMAGE");
  command
      ->add_option("--board", options->board,
                   "chessboard:COLSxROWS:SQUARE_M (inner corners), "
                   "charuco:COLSxROWS:SQUARE_M:MARKER_M:DICT or aprilgrid:COLSxROWS:TAG_M:GAP_M")
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
  command
      ->add_option("--board-error", options->board_sd_m,
                   "How well each corner's place on the board is known: above 0 they are estimated "
                   "too (a print or a sheet that is not true), 0: as described. Left out, "
                   "held-out views decide")
      ->check(CLI::Range(0.0, 0.1))
      ->type_name("METRES");
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
