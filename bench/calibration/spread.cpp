// Whether calibrations know how good they are: many from the same views with other noise, each
// beside the truth in the units of its own standard deviations. mrcal's part is done by
// mrcal.py --spread on the corners written here.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "bench/calibration/corners.h"
#include "bench/calibration/peer.h"
#include "bench/tool.h"
#include "calibration/boards/chessboard.h"
#include "calibration/uncertainty/projection_uncertainty.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip::bench {
namespace {

constexpr double kNoise_px = 0.15;

struct Arguments {
  int runs = 100, views = 12;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--runs", a.runs, "Calibrations")->check(CLI::PositiveNumber);
  app.add_option("--views", a.views, "In each")->check(CLI::Range(4, 100));
  app.add_option("-o,--out", a.out, "Folder: runs/NNN with corners, truth.json, spread.json")
      ->required();
  app.footer("Example:\n  flextip_calibration_spread --runs 100 -o spread\n");
}

struct Truth {
  CornerSet set;  // exact
  CameraCalibration camera;
  std::vector<Pose> T_CB;
  std::vector<std::pair<Eigen::Vector2d, double>> places;  // px, depth (m)
};

Truth MakeTruth(int views) {
  Truth t;
  t.set.board = ParseBoardSpec("chessboard:9x6:0.025");
  t.set.width_px = 640;
  t.set.height_px = 480;
  t.set.focal_px = 500;
  t.set.working_distance_m = 0.4;
  t.camera.width_px = 640;
  t.camera.height_px = 480;
  t.camera.fu_px = t.camera.fv_px = 533;
  t.camera.cu_px = 342;
  t.camera.cv_px = 234;
  t.camera.distortion = Distortion::kOpenCv;
  t.camera.distortion_coefficients = {-0.28, 0.08, 0.001, 0.0002, 0.01};
  t.places = {{{320, 240}, 0.4}, {{60, 60}, 0.4}, {{580, 240}, 0.4}, {{320, 240}, 2.0}};
  const auto points = ChessboardPoints(9, 6, 0.025);
  const CameraModel model(t.camera);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  while (static_cast<int>(t.T_CB.size()) < views) {
    Pose T;
    T.R = ExpRotation({0.6 * u(random), 0.6 * u(random), 0.3 * u(random)});
    const Eigen::Vector3d at = DrawVector<3>(u, random);
    T.p = Eigen::Vector3d(0.08 * at.x(), 0.06 * at.y(), 0.40 + 0.1 * at.z()) -
          T.R * Eigen::Vector3d(0.1, 0.0625, 0);
    BoardSighting seen;
    for (const Eigen::Vector3d& x : points) {
      const auto px = model.Project(T * x);
      if (!px || px->minCoeff() < 5 || px->x() > 634 || px->y() > 474) break;
      seen.ids.push_back(static_cast<int>(seen.ids.size()));
      seen.x_B.push_back(x);
      seen.px.push_back(*px);
    }
    if (seen.px.size() < points.size()) continue;
    t.set.names.push_back(fmt::format("{:03}.png", t.T_CB.size()));
    t.set.seen.push_back(seen);
    t.T_CB.push_back(T);
  }
  return t;
}

void WriteTruth(const std::filesystem::path& file, const Truth& t) {
  nlohmann::json poses = nlohmann::json::array(), places = nlohmann::json::array();
  for (const Pose& T : t.T_CB) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> m = T.Matrix();
    poses.push_back(std::vector<double>(m.data(), m.data() + 16));
  }
  for (const auto& [px, depth_m] : t.places) {
    const Eigen::Vector3d ray = CameraModel(t.camera).Unproject(px).value();
    const Eigen::Vector3d x_C = ray / ray.z() * depth_m;
    places.push_back({{"px", {px.x(), px.y()}}, {"x_C", {x_C.x(), x_C.y(), x_C.z()}}});
  }
  std::ofstream(file) << nlohmann::json{
      {"fu_px", t.camera.fu_px},
      {"T_CB", poses},
      {"places", places}}.dump(1);
}

CornerSet Noised(const CornerSet& exact, std::mt19937& random) {
  std::normal_distribution<double> noise(0, kNoise_px);
  CornerSet set = exact;
  for (BoardSighting& seen : set.seen) {
    for (Eigen::Vector2d& px : seen.px) px += DrawVector<2>(noise, random);
  }
  return set;
}

// Errors in units of the standard deviations claimed.
struct Score {
  int runs = 0, focal_inside = 0;
  double focal_squares = 0, projection_nees = 0;
  int projections = 0;

  void AddFocal(double error, double sd) {
    ++runs;
    focal_inside += std::abs(error) < sd;
    focal_squares += std::pow(error / sd, 2);
  }
  nlohmann::json Json() const {
    nlohmann::json json = {{"runs", runs},
                           {"focal_inside_1_sd", double(focal_inside) / runs},
                           {"focal_normalised_square", focal_squares / runs}};
    if (projections > 0) json["projection_nees_of_2"] = projection_nees / projections;
    return json;
  }
};

// Where a point that stands still relative to the boards is seen, by a calibration.
void AddProjections(const Truth& t, const CameraSolution& found, Score& score) {
  const auto uncertainty = ProjectionUncertainty::Of(found);
  if (!uncertainty) return;
  for (const auto& [px, depth_m] : t.places) {
    const Eigen::Vector3d ray = CameraModel(t.camera).Unproject(px).value();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const SolvedView& view : found.views) {
      mean += view.T_CB * (t.T_CB[view.index].Inverse() * (ray / ray.z() * depth_m)) /
              static_cast<double>(found.views.size());
    }
    const Eigen::Vector2d error = CameraModel(found.camera).Project(mean).value() - px;
    score.projection_nees += MahalanobisSquared(error, *uncertainty->CovariancePx(px, depth_m));
    ++score.projections;
  }
}

void Run(Arguments& a) {
  const Truth truth = MakeTruth(a.views);
  std::mt19937 random(1);
  Score opencv, own;
  for (int run = 0; run < a.runs; ++run) {
    const CornerSet set = Noised(truth.set, random);
    WriteCorners(a.out / "runs" / fmt::format("{:03}", run), set);
    const CalibrationAnswer cv = CalibrateByOpenCv(set, 5);
    opencv.AddFocal(cv.camera.fu_px - truth.camera.fu_px, cv.sd.front());
    const CalibrationAnswer mine = CalibrateByFlextip(set, LensModel{Distortion::kOpenCv, 5});
    own.AddFocal(mine.camera.fu_px - truth.camera.fu_px, mine.sd.front());
    AddProjections(truth, *mine.solution, own);
  }
  WriteTruth(a.out / "truth.json", truth);
  const nlohmann::json result = {{"opencv", opencv.Json()}, {"flextip", own.Json()}};
  std::ofstream(a.out / "spread.json") << result.dump(1) << '\n';
  fmt::print("{}\n", result.dump(1));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool<flextip::bench::Arguments>(
      argc, argv, "Whether calibrations know how good they are", flextip::bench::AddOptions,
      flextip::bench::Run);
}
