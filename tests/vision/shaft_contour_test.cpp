// The shaft's outline found in rendered frames, the pose beside the truth.
#include "core/linear_algebra.h"
#include "vision/outline/contour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <sstream>

#include "core/error.h"
#include "core/rotation.h"
#include "recording/recording_reader.h"
#include "simulation/render/laparoscope.h"
#include "tests/simulation/render_test_scene.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// The middle of the sample's picture.
CameraCalibration HalfCamera() {
  CameraCalibration camera = render_test::SampleCamera();
  camera.width_px = 640;
  camera.height_px = 360;
  camera.cu_px = 323;
  camera.cv_px = 177.5;
  camera.T_RC = Pose{};
  camera.gamma = 2.2;
  return camera;
}

simulation::LaparoscopeOptions Scope() {
  simulation::LaparoscopeOptions options;
  options.tissue.point_R = {0, 0, 0.17};
  options.tissue.normal_R = {0.2, -0.3, -1};
  options.grey = true;
  options.seed = 3;
  return options;
}

TubeShape Tube() {
  TubeShape tube;
  tube.diameter_m = 0.005;
  tube.collar = TubeShape::Collar{-0.0345, -0.0255, 0.0065};
  return tube;
}

struct Draw {
  Pose T_CE;
  Vector2d bend;
};

// The tip left of the middle, the shaft in from the right, up to 0.5 rad out of the picture plane.
Draw DrawTube(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal;
  const double turn = -0.3 + 0.4 * unit(random), tilt = 0.5 * unit(random);
  Draw draw;
  draw.T_CE.R = ExpRotation({0, 0, turn}) * ExpRotation({0, M_PI - tilt, 0}) *
                ExpRotation({3 * unit(random), 0, 0});
  draw.T_CE.p = {-0.012 + 0.008 * unit(random), 0.006 * unit(random), 0.11 + 0.02 * unit(random)};
  draw.bend = {10 * normal(random), 10 * normal(random)};
  return draw;
}

simulation::ShaftCurve CurveOf(const Draw& draw) {
  simulation::ShaftCurve curve;
  curve.diameter_m = Tube().diameter_m;
  curve.T_RE = draw.T_CE;
  constexpr int kPieces = 150;
  for (int i = kPieces; i >= 0; --i) {
    curve.points.push_back(draw.T_CE * TubeCentre(draw.bend, 0.2 * i / kPieces).x_E);
  }
  return curve;
}

// A prediction that knows little but the roll.
Matrix6 WidePrior(const Pose& T_CE) {
  const Vector3d axis = T_CE.R.col(0);
  Matrix6 covariance = 1e-4 * Matrix6::Identity();
  covariance.topLeftCorner<3, 3>() =
      2.5e-3 * (Eigen::Matrix3d::Identity() - axis * axis.transpose()) +
      4e-4 * axis * axis.transpose();
  return covariance;
}

// Moved by `px` aside in the picture and turned by some hundredths of a radian.
Pose Mispredicted(const Pose& T_CE, double px, double turn, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double angle = M_PI * unit(random), metres = px * T_CE.p.z() / HalfCamera().fu_px;
  Vector6 step;
  step << turn * unit(random), turn * unit(random), turn * unit(random), metres * std::cos(angle),
      metres * std::sin(angle), 0.002 * unit(random);
  return MovePose(T_CE, step);
}

// Errors along the line of sight, along the tube across it, and aside (m), and of the direction
// as seen in the picture (rad).
struct Errors {
  double depth, along, aside, direction;
};
Errors ErrorsOf(const Pose& T_CE, const Pose& truth) {
  const Vector3d sight = truth.p.normalized(), t = truth.R.col(0);
  const Vector3d aside = sight.cross(t).normalized(), along = aside.cross(sight);
  const Vector3d e = T_CE.p - truth.p;
  return {e.dot(sight), e.dot(along), e.dot(aside), (T_CE.R.col(0) - t).dot(aside)};
}

// Of all but the roll: 5 when the covariance is right.
double NormalisedError(const ContourFit& fit, const Pose& truth) {
  Eigen::Matrix<double, 5, 6> pick = Eigen::Matrix<double, 5, 6>::Zero();
  pick.topLeftCorner<2, 3>() = NormalBasis(truth.R.col(0)).transpose();
  pick.bottomRightCorner<3, 3>().setIdentity();
  const Eigen::Matrix<double, 5, 1> e = pick * PoseDifference(truth, fit.T_CE);
  return e.dot(Ldlt(pick * fit.covariance * pick.transpose()).Solve(e));
}

ContourOptions LightAtLens() {
  ContourOptions options;
  options.errors = ContourErrors::LightAtLens();
  return options;
}

// How the fits of many frames came out.
struct Tally {
  int frames = 0, usable = 0, wrong = 0;  // wrong: usable, and 0.5 mm or more off in the picture
  double depth = 0, along = 0, aside = 0, direction = 0, normalised = 0;  // squares of those right
  void Add(const ContourFit& fit, const Pose& truth) {
    ++frames;
    if (!fit.IsUsable()) return;
    ++usable;
    const Errors e = ErrorsOf(fit.T_CE, truth);
    if (std::hypot(e.along, e.aside) > 5e-4) {
      ++wrong;
      return;
    }
    depth += e.depth * e.depth;
    along += e.along * e.along;
    aside += e.aside * e.aside;
    direction += e.direction * e.direction;
    normalised += NormalisedError(fit, truth);
  }
  double Rms(double squares) const { return std::sqrt(squares / (usable - wrong)); }
};

Tally FitRenders(const simulation::LaparoscopeOptions& scope, const ContourOptions& options,
                 int frames, double off_px) {
  const simulation::Laparoscope laparoscope(HalfCamera(), render_test::HexagonCollar(), scope);
  const ShaftContour contour(CameraModel(HalfCamera()), Tube(), options);
  std::mt19937 random(11);
  Tally tally;
  for (int i = 0; i < frames; ++i) {
    const Draw draw = DrawTube(random);
    const Image frame = laparoscope.Render(CurveOf(draw), i);
    const Pose predicted = Mispredicted(draw.T_CE, off_px, 0.01, random);
    tally.Add(contour.Fit(frame, predicted, WidePrior(predicted)), draw.T_CE);
  }
  return tally;
}

TEST(ShaftContour, FindsBentShaftsAndKnowsHowWell) {
  const Tally tally = FitRenders(Scope(), LightAtLens(), 24, 10);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.usable, 18);
  EXPECT_LT(tally.Rms(tally.aside), 1.0e-5);
  EXPECT_LT(tally.Rms(tally.along), 3.0e-5);
  EXPECT_LT(tally.Rms(tally.depth), 6e-4);
  EXPECT_LT(tally.Rms(tally.direction), 4e-4);
  // 5 expected; of 18 fits the mean scatters by 0.75.
  const double nees = tally.normalised / (tally.usable - tally.wrong);
  EXPECT_GT(nees, 2.5);
  EXPECT_LT(nees, 7.5);
}

TEST(ShaftContour, AnOccluderIsSeenThroughOrAdmitted) {
  simulation::LaparoscopeOptions scope = Scope();
  simulation::Occluder other;
  other.a_R = {-0.02, -0.05, 0.07};
  other.b_R = {0.0, 0.05, 0.07};
  other.radius_m = 0.0015;
  other.albedo_bgr = {0.2, 0.2, 0.2};
  other.specular = 1;
  scope.occluders = {other};
  const Tally tally = FitRenders(scope, LightAtLens(), 20, 10);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.usable, 8);
  EXPECT_LT(tally.Rms(tally.aside), 2e-5);
}

TEST(ShaftContour, CatchesTwentyPixelsOfMotion) {
  const Tally tally = FitRenders(Scope(), {}, 20, 20);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_GE(tally.usable, 12);
}

TEST(ShaftContour, WithoutAShaftNothingIsFound) {
  const simulation::Laparoscope laparoscope(HalfCamera(), {}, Scope());
  const ShaftContour contour(CameraModel(HalfCamera()), Tube());
  std::mt19937 random(2);
  const Image empty = laparoscope.Render(render_test::HiddenShaft(), 0);
  for (int i = 0; i < 40; ++i) {
    const Pose guess = DrawTube(random).T_CE;
    EXPECT_FALSE(contour.Fit(empty, guess, WidePrior(guess)).IsUsable());
  }
}

TEST(ShaftContour, LinearisationPointsBackFromASmallMove) {
  const simulation::Laparoscope laparoscope(HalfCamera(), render_test::HexagonCollar(), Scope());
  const ShaftContour contour(CameraModel(HalfCamera()), Tube(), LightAtLens());
  std::mt19937 random(5);
  const Draw draw = DrawTube(random);
  const Image frame = laparoscope.Render(CurveOf(draw), 0);
  const Matrix6 roll_known = 1e-2 * WidePrior(draw.T_CE).inverse();
  Matrix6 covariance;
  const auto improved = [&](const Pose& T_CE) {
    const ContourTerm term = contour.Linearise(frame, T_CE, draw.bend, 4);
    EXPECT_GT(term.points, 30);
    covariance = (term.JtJ + roll_known).inverse();
    return MovePose(T_CE, -covariance * term.Jtr);
  };
  const Pose best = improved(draw.T_CE);
  const Vector3d aside = draw.T_CE.p.cross(draw.T_CE.R.col(0)).normalized();
  const double sd = std::sqrt(aside.dot(covariance.bottomRightCorner<3, 3>() * aside));
  EXPECT_LT(sd, 1e-5);
  for (int k = 0; k < 4; ++k) {  // two pixels aside, or a turn about the line of sight
    Vector6 off = Vector6::Zero();
    off[k < 2 ? 3 + k : 2] = k < 2 ? 2e-4 : (k == 2 ? 0.01 : -0.01);
    const Pose back = improved(MovePose(best, off));
    // Both see other bits of the background: the difference has the errors of both.
    const Errors e = ErrorsOf(back, best);
    EXPECT_LT(std::abs(e.aside), 4 * std::sqrt(2.0) * sd) << k;
    EXPECT_LT(std::abs(e.direction), 1e-3) << k;
  }
}

TEST(ShaftContour, RefusesColourAndSizesThatAreNone) {
  const CameraModel camera(HalfCamera());
  const ShaftContour contour(camera, Tube());
  EXPECT_THROW(contour.Linearise(Image(640, 360, 3), {}, {0, 0}, 4), InputError);
  TubeShape thin = Tube();
  thin.diameter_m = 0;
  EXPECT_THROW(ShaftContour(camera, thin), InputError);
}

// Frames of a ray tracer outside the project: the shaft's end is flat, its light stands beside the
// lens and throws a narrow shadow along one side, which looks like the shaft's own dark rim: that
// side is seen 0.8 px too far out.
TEST(ShaftContour, FindsTheShaftInTheRenderedRecording) {
  const std::filesystem::path data = FLEXTIP_SOURCE_DIR "/testdata/recordings";
  const Recording recording = ReadRecording(data / "rendered").recording;
  const CameraCalibration& camera = recording.cam0->calibration;
  TubeShape tube = Tube();
  tube.round_end = false;
  tube.collar->radius_m = 0.0085;  // with its shadow
  const ShaftContour contour(CameraModel(camera), tube);
  std::ifstream in(data / "rendered.truth.csv");
  std::string line;
  std::getline(in, line);
  std::mt19937 random(4);
  Tally tally;
  for (const auto& frame : recording.cam0->filenames) {
    std::getline(in, line);
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    TimeNs t_ns = 0;
    Vector3d p;
    Eigen::Quaterniond q;
    fields >> t_ns >> p.x() >> p.y() >> p.z() >> q.w() >> q.x() >> q.y() >> q.z();
    ASSERT_EQ(t_ns, frame.t_ns);
    const auto file = data / "rendered" / "cam0" / "data" / frame.value;
    const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    Image image(picture.cols, picture.rows, 1);
    std::copy(picture.datastart, picture.dataend, image.data.begin());
    const Pose truth = camera.T_RC.Inverse() * Pose::FromQuaternion(q, p);
    const Pose predicted = Mispredicted(truth, 10, 0.01, random);
    tally.Add(contour.Fit(image, predicted, WidePrior(predicted)), truth);
  }
  EXPECT_EQ(tally.usable, 8);
  EXPECT_EQ(tally.wrong, 0);
  EXPECT_LT(tally.Rms(tally.along), 3e-5);
  EXPECT_LT(tally.Rms(tally.aside), 5e-5);
  EXPECT_LT(tally.Rms(tally.direction), 2e-4);
  EXPECT_LT(tally.Rms(tally.depth), 4e-3);
}

}  // namespace
}  // namespace flextip
