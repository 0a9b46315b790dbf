// Calibrations of one camera from the same corners: OpenCV's and this program's; mrcal's figures
// are added by mrcal.py.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "bench/calibration/corners.h"
#include "bench/calibration/peer.h"
#include "bench/tool.h"
#include "calibration/camera/board_shape.h"
#include "calibration/uncertainty/projection_uncertainty.h"
#include "core/error.h"

namespace flextip::bench {
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
      "  bench/calibration/mrcal.py out\n");
}

using Calibrate = std::function<CalibrationAnswer(const CornerSet&)>;

// Both halves by the other; null where a lens from half of the views cannot be had or has no place
// for a corner of the other half.
nlohmann::json HeldOutRms(const CornerSet& set, const Calibrate& calibrate) {
  double sum_px2 = 0;
  try {
    for (int half : {0, 1}) {
      const double rms = FittedPosesRms(calibrate(HalfOf(set, half)), HalfOf(set, 1 - half));
      sum_px2 += 0.5 * rms * rms;
    }
  } catch (const WorkError&) {
    return nullptr;
  }
  return std::sqrt(sum_px2);
}

nlohmann::json Row(const std::string& peer, const std::string& model, const CornerSet& set,
                   const Calibrate& calibrate) {
  CalibrationAnswer whole;
  try {
    whole = calibrate(set);
  } catch (const WorkError& error) {
    return {{"peer", peer}, {"model", model}, {"failed", error.what()}};
  }
  nlohmann::json row = {{"peer", peer},
                        {"model", model},
                        {"outliers", whole.outliers},
                        {"rms_px", whole.rms_px},
                        {"heldout_rms_px", HeldOutRms(set, calibrate)},
                        {"fu_px", whole.camera.fu_px},
                        {"fu_sd_px", whole.sd.front()},
                        {"seconds", whole.seconds}};
  const auto uncertainty =
      whole.solution ? ProjectionUncertainty::Of(*whole.solution) : std::nullopt;
  if (!uncertainty) return row;
  const LensModel lens{whole.camera.distortion,
                       static_cast<int>(whole.camera.distortion_coefficients.size())};
  row["lens"] = lens.Name();
  row["board_shape_mm"] = 1e3 * SizeOf(whole.shape).first;
  row["warp_mm"] = {1e3 * whole.warp.bulge_m.x(), 1e3 * whole.warp.bulge_m.y()};
  row["median_depth_m"] = MedianBoardDepth(*whole.solution);
  for (const auto& [name, depth_m] :
       {std::pair("near", set.working_distance_m), std::pair("infinity", HUGE_VAL)}) {
    const UncertaintyMap map = MapUncertainty(*uncertainty, depth_m, 13, 10);
    const Eigen::Vector2d middle(0.5 * set.width_px, 0.5 * set.height_px);
    row[fmt::format("sd_{}_mean_px", name)] = map.MeanPx();
    row[fmt::format("sd_{}_max_px", name)] = map.LargestPx();
    row[fmt::format("sd_{}_centre_px", name)] =
        WorstSd(uncertainty->CovariancePx(middle, depth_m).value());
  }
  return row;
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
  const auto add_own = [&](const std::string& name, const std::optional<LensModel>& lens,
                           std::optional<double> board_sd_m) {
    rows.push_back(Row("flextip", name, set, [&](const CornerSet& s) {
      return CalibrateByFlextip(s, lens, board_sd_m);
    }));
    fmt::print("{}\n", rows.back().dump());
  };
  for (const int terms : {5, 8}) {
    const LensModel lens{Distortion::kOpenCv, terms};
    add_own(fmt::format("{} terms, board as described", terms), lens, 0.0);
    add_own(fmt::format("{} terms", terms), lens, {});
  }
  add_own("chosen, board as described", {}, 0.0);
  add_own("chosen", {}, {});
  std::ofstream(a.out / "rows.json") << rows.dump(1) << '\n';
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool<flextip::bench::Arguments>(
      argc, argv, "Calibrations of one camera from the same corners", flextip::bench::AddOptions,
      flextip::bench::Run);
}
