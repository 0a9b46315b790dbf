// Calibrations of one camera from the same corners: OpenCV's and this program's; mrcal's figures
// are added by calibration_mrcal.py.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/calibration_corners.h"
#include "bench/calibration_peer.h"
#include "bench/tool.h"

namespace flextip {
namespace {

struct Arguments {
  std::vector<std::filesystem::path> images;
  std::string board;
  double distance_m = 0;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("images", a.images, "Of one camera; none: the corners in OUT are used");
  app.add_option("--board", a.board, "As in flextip calibrate camera");
  app.add_option("--distance", a.distance_m, "Working distance, m");
  app.add_option("-o,--out", a.out, "Folder for the corners and the rows")->required();
  app.footer(
      "Example:\n"
      "  flextip_calibration_compare left*.jpg --board chessboard:9x6:0.025 --distance 0.4 -o out\n"
      "  bench/calibration_mrcal.py out\n");
}

nlohmann::json Row(const std::string& peer, const std::string& model, const CornerSet& set,
                   const std::function<CalibrationAnswer(const CornerSet&)>& calibrate) {
  const CalibrationAnswer whole = calibrate(set);
  double sum_px2 = 0;
  for (int half : {0, 1}) {
    const double rms = FittedPosesRms(calibrate(HalfOf(set, half)), HalfOf(set, 1 - half));
    sum_px2 += 0.5 * rms * rms;
  }
  return {{"peer", peer},
          {"model", model},
          {"outliers", whole.outliers},
          {"rms_px", whole.rms_px},
          {"heldout_rms_px", std::sqrt(sum_px2)},
          {"fu_px", whole.camera.fu_px},
          {"fu_sd_px", whole.sd.front()},
          {"seconds", whole.seconds}};
}

void Run(Arguments& a) {
  CornerSet set;
  if (a.images.empty()) {
    set = ReadCorners(a.out);
  } else {
    set = DetectCorners(a.images, ParseBoardSpec(a.board));
    set.working_distance_m = a.distance_m;
    WriteCorners(a.out, set);
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const int terms : {4, 5, 8, 12}) {
    rows.push_back(Row("OpenCV", fmt::format("{} terms", terms), set,
                       [&](const CornerSet& s) { return CalibrateByOpenCv(s, terms); }));
    fmt::print("{}\n", rows.back().dump());
  }
  std::ofstream(a.out / "rows.json") << rows.dump(1) << '\n';
}

}  // namespace
}  // namespace flextip

int main(int argc, char** argv) {
  return flextip::RunTool<flextip::Arguments>(
      argc, argv, "Calibrations of one camera from the same corners", flextip::AddOptions,
      flextip::Run);
}
