// Boards that are not as they are described: found, told from true ones, and paid for in the
// covariance.
#include "calibration/camera/board_shape.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "calibration/camera/bundle.h"
#include "calibration/camera/corner_error.h"
#include "calibration/camera/start.h"
#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "tests/calibration/camera_synthetic.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr double kOff_m = 1e-4;

using Offsets = std::map<int, Eigen::Vector3d>;

Offsets RandomOffsets(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> off(0, kOff_m);
  Offsets offsets;
  for (int id = 0; id < 54; ++id) offsets[id] = {off(random), off(random), off(random)};
  return offsets;
}

// A board that is described wrongly by `offsets`: the corners stand where they were seen.
void Misdescribe(const Offsets& offsets, std::vector<SolvedView>& views) {
  for (SolvedView& view : views) {
    for (std::size_t i = 0; i < view.x_B.size(); ++i) view.x_B[i] -= offsets.at(view.ids[i]);
  }
}

CameraSolution Exact(const Synthetic& truth, unsigned seed) {
  const auto views = Seen(truth, seed);
  const auto start = StartSolution(AtTruth(truth, views, {}).views, 640, 480, false);
  return AtTruth(truth, views, start.value().views);
}

TEST(BoardShape, EveryDerivativeIsThatOfDifferences) {
  CameraSolution s = Exact({.bulge_m = {3e-4, -5e-4}, .noise_px = 0.0, .views = 3}, 1);
  const auto error = MakeCornerError(s, s.views[1], 7, true);
  Eigen::VectorXd x(8 + 2 + 6 + 3);
  x << Intrinsics(s.camera), 2e-4, 1e-4, 0.01, -0.02, 0.015, 1e-3, -2e-3, 3e-3, 1e-4, -2e-4, 3e-4;
  const auto blocks = [](const Eigen::VectorXd& v) {
    return std::vector<const double*>{v.data(), v.data() + 8, v.data() + 10, v.data() + 16};
  };
  Eigen::Matrix<double, 2, 8, Eigen::RowMajor> lens;
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> warp;
  Eigen::Matrix<double, 2, 6, Eigen::RowMajor> pose;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> place;
  double* jacobians[] = {lens.data(), warp.data(), pose.data(), place.data()};
  Eigen::Vector2d r;
  ASSERT_TRUE(error->Evaluate(blocks(x).data(), r.data(), jacobians));
  Eigen::MatrixXd J(2, x.size());
  J << lens, warp, pose, place;
  const auto numeric = NumericJacobian(
      [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
        Eigen::Vector2d at;
        error->Evaluate(blocks(v).data(), at.data(), nullptr);
        return at;
      },
      x, 1e-4);
  EXPECT_LT((J - numeric).cwiseAbs().maxCoeff(), 1e-6 * J.cwiseAbs().maxCoeff());
}

// Corners off by a tenth of a millimetre: found from views with noise, how far they scatter too.
TEST(BoardShape, IsFoundWithItsScatter) {
  const Synthetic truth{.noise_px = 0.02, .views = 12};
  CameraSolution s = Exact(truth, 21);
  const Offsets known = RandomOffsets(5);
  Misdescribe(known, s.views);
  ASSERT_TRUE(AdjustBundle(s));
  EXPECT_GT(s.noise_px, 5 * truth.noise_px);
  ASSERT_TRUE(EstimateBoardShape(s));
  EXPECT_NEAR(s.noise_px, truth.noise_px, 0.05 * truth.noise_px);
  EXPECT_NEAR(s.shape.sd_m, kOff_m, 0.15 * kOff_m);
  double squares = 0.0;
  for (const auto& [id, offset] : s.shape.offset_B) {
    squares += (offset - known.at(id)).squaredNorm() / 54;
  }
  EXPECT_LT(std::sqrt(squares), 0.35 * std::sqrt(3.0) * kOff_m);
  EXPECT_LT(std::abs(s.camera.fu_px - truth.camera.fu_px), 1.0);
}

// Other boards, other noise, the same views: the lens's errors are as large as the covariance says,
// which is not so where the shape is taken for known.
TEST(BoardShape, CovarianceCountsTheShape) {
  constexpr int kTrials = 40, kNumbers = 8;
  const Synthetic truth{.noise_px = 0.0, .views = 8};
  const CameraSolution known = Exact(truth, 100);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.05);
  double nees = 0.0, nees_as_known = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    CameraSolution s = known;
    Misdescribe(RandomOffsets(100 + trial), s.views);
    for (SolvedView& view : s.views) {
      for (Eigen::Vector2d& px : view.px) px += DrawVector<2>(noise, random);
    }
    ASSERT_TRUE(AdjustBundle(s));
    ASSERT_TRUE(EstimateBoardShape(s));
    const Eigen::VectorXd error = Intrinsics(s.camera) - Intrinsics(truth.camera);
    const auto weigh = [&](const CameraSolution& with) {
      const Eigen::MatrixXd P = with.Covariance().topLeftCorner(kNumbers, kNumbers);
      return MahalanobisSquared(error, P) / kTrials;
    };
    nees += weigh(s);
    CameraSolution held = s;
    ASSERT_TRUE(AdjustBundle(held));
    held.noise_px = s.noise_px;
    nees_as_known += weigh(held);
  }
  // The mean of 40 such: 8, with a standard deviation of sqrt(2 * 8 / 40) = 0.63.
  EXPECT_NEAR(nees, kNumbers, 3 * 0.63);
  EXPECT_GT(nees_as_known, 1.5 * kNumbers);
}

CameraCalibrationResult Calibrate(const std::vector<BoardView>& views) {
  CameraCalibrationOptions options;
  options.lens = {Distortion::kRadialTangential, 4};
  return CalibrateCamera(views, 640, 480, ParseBoardSpec("chessboard:9x6:0.025"), options);
}

// The corners that came with the pictures: 0.578 px in OpenCV with five terms, and no lens does
// better.
TEST(BoardShape, IsWhatWasWrongWithALaparoscopesBoard) {
  const fs::path folder = FLEXTIP_SHARED_DIR "/data/laparoscope/left_chessboard";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const auto corners = BoardCorners(ParseBoardSpec("chessboard:14x10:0.003"));
  std::vector<BoardView> views;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.path().string().ends_with(".points.txt")) continue;
    BoardView view{entry.path().filename().string(), {}};
    std::ifstream file(entry.path());
    for (Eigen::Vector2d px; file >> px.x() >> px.y();) {
      view.sighting.ids.push_back(static_cast<int>(view.sighting.px.size()));
      view.sighting.x_B.push_back(corners.at(view.sighting.px.size()));
      view.sighting.px.push_back(px);
    }
    views.push_back(std::move(view));
  }
  ASSERT_EQ(views.size(), 9u);
  std::sort(views.begin(), views.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  CameraCalibrationOptions options;
  options.lens = {Distortion::kOpenCv, 5};
  const auto calibrate = [&] {
    return CalibrateCamera(views, 1920, 1080, ParseBoardSpec("chessboard:14x10:0.003"), options);
  };
  const auto shaped = calibrate();
  ASSERT_TRUE(shaped.IsUsable()) << shaped.message;
  EXPECT_GT(shaped.solution.shape.sd_m, 0.0) << shaped.shape_reason;
  EXPECT_LT(shaped.solution.RmsPx(true), 0.5);
  EXPECT_LT(shaped.heldout_rms_px, 0.5);
  RecordProperty("rms_px", fmt::format("{:.4f}", shaped.solution.RmsPx()));
  RecordProperty("heldout_px", fmt::format("{:.4f}", shaped.heldout_rms_px));
  options.board_sd_m = 0.0;
  const auto described = calibrate();
  ASSERT_TRUE(described.IsUsable()) << described.message;
  EXPECT_NEAR(described.solution.RmsPx(true), 0.578, 0.03);
}

TEST(BoardShape, HeldOutViewsTellTrueBoardsFromOthers) {
  const Synthetic truth{.noise_px = 0.1, .views = 10};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    auto views = Seen(truth, seed);
    const auto as_described = Calibrate(views);
    ASSERT_TRUE(as_described.IsUsable());
    EXPECT_EQ(as_described.solution.shape.sd_m, 0.0) << seed << ": " << as_described.shape_reason;
    const Offsets offsets = RandomOffsets(seed);
    for (BoardView& view : views) {
      for (std::size_t i = 0; i < view.sighting.x_B.size(); ++i) {
        view.sighting.x_B[i] -= offsets.at(view.sighting.ids[i]);
      }
    }
    const auto shaped = Calibrate(views);
    ASSERT_TRUE(shaped.IsUsable());
    EXPECT_GT(shaped.solution.shape.sd_m, 0.5 * kOff_m) << seed << ": " << shaped.shape_reason;
    EXPECT_NEAR(shaped.solution.noise_px, 0.1, 0.01) << seed;
  }
}

}  // namespace
}  // namespace flextip
