// A camera's lens from pictures of a board: calibrate_camera BOARD PICTURE...
// BOARD is chessboard:9x6:0.025 and its like (docs/usage/calibrate.md).
#include <fmt/format.h>

#include <flextip/calibration/boards/board_pictures.h>
#include <flextip/calibration/verdict/camera.h>
#include <flextip/core/error.h>

using namespace flextip;

int main(int argc, char** argv) try {
  if (argc < 3) throw InputError("usage: calibrate_camera BOARD PICTURE...");
  const CornersFile corners = CornersOf({.images = {argv + 2, argv + argc}, .board = argv[1]});
  const JudgedCamera camera = CalibrateAndJudge(corners);
  if (!camera.result.IsUsable()) throw WorkError(camera.result.message);

  fmt::print("{}\n", camera.verdict.says);
  for (const auto& [name, value, sd] : camera.verdict.values) {
    fmt::print("{:<30} {}{}\n", name, value, sd.empty() ? "" : ", standard deviation " + sd);
  }
  for (const std::string& reason : camera.verdict.reasons) fmt::print("beware: {}\n", reason);
  if (!camera.verdict.next.empty()) fmt::print("next: {}\n", camera.verdict.next);
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
