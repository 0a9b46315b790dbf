#include "apps/calibrate/camera/lens_options.h"

namespace flextip {

CameraCalibrationOptions LensOptions::Calibration() const {
  CameraCalibrationOptions calibration;
  if (distortion == "radial-tangential") calibration.lens = {Distortion::kRadialTangential, 4};
  if (distortion == "equidistant") calibration.lens = {Distortion::kEquidistant, 4};
  if (distortion == "opencv") calibration.lens = {Distortion::kOpenCv, terms};
  if (warp != "auto") calibration.warp = warp == "on";
  calibration.board_sd_m = board_sd_m;
  return calibration;
}

void AddLensOptions(CLI::App& command, LensOptions& options) {
  command
      .add_option("--board", options.board,
                  "chessboard:COLSxROWS:SQUARE_M (inner corners), "
                  "charuco:COLSxROWS:SQUARE_M:MARKER_M:DICT or aprilgrid:COLSxROWS:TAG_M:GAP_M")
      ->required()
      ->type_name("SPEC");
  command
      .add_option("--distortion", options.distortion,
                  "auto (by the error of held-out views), radial-tangential, opencv, equidistant")
      ->check(CLI::IsMember({"auto", "radial-tangential", "opencv", "equidistant"}))
      ->capture_default_str();
  command.add_option("--terms", options.terms, "Terms of the opencv model")
      ->check(CLI::IsMember({5, 8, 12}))
      ->capture_default_str();
  command.add_option("--warp", options.warp, "Whether the board may be bent: auto, on or off")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  command
      .add_option("--board-error", options.board_sd_m,
                  "How well each corner's place on the board is known: above 0 they are estimated "
                  "too (a print or a sheet that is not true), 0: as described. Left out, "
                  "held-out views decide")
      ->check(CLI::Range(0.0, 0.1))
      ->type_name("METRES");
}

}  // namespace flextip
