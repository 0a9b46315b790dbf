#include "bench/calibration/chain_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/draw_vector.h"
#include "core/rotation.h"
#include "recording/recording_writer.h"
#include "vision/camera_model.h"

namespace flextip::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kSquare_m = 0.005, kDistance_m = 0.1;
constexpr int kColumns = 8, kRows = 6;  // inner corners
constexpr double kWristPosition_m = 1e-4, kWristTurn_rad = 5e-4;
constexpr TimeNs kPeriod_ns = 40'000'000;

CameraCalibration Camera() {
  CameraCalibration c;
  c.width_px = 480;
  c.height_px = 360;
  c.fu_px = 640;
  c.fv_px = 638;
  c.cu_px = 243.7;
  c.cv_px = 177.2;
  c.distortion_coefficients = {-0.18, 0.06, 0.0006, -0.0004};
  c.gamma = 2.2;
  c.rate_hz = 25;
  c.T_RC = {ExpRotation({2.0, 0.3, -0.4}), {0.1, -0.05, 0.2}};
  return c;
}

/// Six tags of 5 mm around the shaft; E is 15 mm before them.
TagCollar Collar() {
  TagCollar collar;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    const Eigen::Vector3d out(0, std::cos(angle), std::sin(angle));
    CollarTag tag{i, 0.005, {}};
    tag.T_EG.R.col(0) = Eigen::Vector3d::UnitX();
    tag.T_EG.R.col(2) = -out;
    tag.T_EG.R.col(1) = tag.T_EG.R.col(2).cross(tag.T_EG.R.col(0));
    tag.T_EG.p = 0.0055 * out + Eigen::Vector3d(-0.015, 0, 0);
    collar.tags.push_back(tag);
  }
  return collar;
}

/// What of a white sheet a chessboard's place reflects; the first square is black.
float Reflectance(double x, double y) {
  const bool on_squares = x >= -1 && y >= -1 && x < kColumns && y < kRows;
  const bool black = on_squares && (static_cast<int>(std::floor(x) + std::floor(y)) & 1) == 0;
  return black ? 0.04F : 0.55F;
}

/// The board as the camera's lens throws it on the film.
simulation::LinearImage DrawBoard(const CameraModel& model, const Pose& T_CB) {
  constexpr int kFine = 4;
  const CameraCalibration& c = model.Calibration();
  const Pose T_BC = T_CB.Inverse();
  cv::Mat_<cv::Vec2f> corners(c.height_px + 1, c.width_px + 1), fine;  // of the pixels, in squares
  for (int y = 0; y <= c.height_px; ++y) {
    for (int x = 0; x <= c.width_px; ++x) {
      const Eigen::Vector3d ray = T_BC.R * model.Unproject({x - 0.5, y - 0.5}).value();
      const Eigen::Vector3d at = (T_BC.p - ray * (T_BC.p.z() / ray.z())) / kSquare_m;
      corners(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    }
  }
  simulation::LinearImage image{c.width_px, c.height_px, 1, {}};
  image.data.resize(static_cast<std::size_t>(c.width_px) * c.height_px);
  for (int y = 0; y < c.height_px; ++y) {
    for (int x = 0; x < c.width_px; ++x) {
      float sum = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const int column = k % kFine, row = k / kFine;
        const float a = (static_cast<float>(column) + 0.5F) / kFine,
                    b = (static_cast<float>(row) + 0.5F) / kFine;
        const cv::Vec2f at = (1 - b) * ((1 - a) * corners(y, x) + a * corners(y, x + 1)) +
                             b * ((1 - a) * corners(y + 1, x) + a * corners(y + 1, x + 1));
        sum += Reflectance(at[0], at[1]);
      }
      *image.At(x, y) = sum / (kFine * kFine);
    }
  }
  cv::Mat film(c.height_px, c.width_px, CV_32FC1, image.data.data());
  cv::GaussianBlur(film, film, {0, 0}, 0.7);
  return image;
}

/// Shot and read noise as the renderer's defaults, gamma, 8 bit.
void WriteFilm(const fs::path& file, const simulation::LinearImage& light, double gamma,
               std::mt19937& random) {
  constexpr double kFullWell = 15000, kRead = 15;
  std::normal_distribution<double> normal;
  cv::Mat_<std::uint8_t> image(light.height_px, light.width_px);
  for (std::size_t i = 0; i < light.data.size(); ++i) {
    const double electrons = kFullWell * std::max(0.0F, light.data[i]);
    const double signal =
        (electrons + std::sqrt(electrons + kRead * kRead) * normal(random)) / kFullWell;
    image.data[i] = static_cast<std::uint8_t>(
        std::lround(255 * std::pow(std::clamp(signal, 0.0, 1.0), 1 / gamma)));
  }
  cv::imwrite(file.string(), image);
}

/// The board's middle before the camera, tilted by up to half a radian.
Pose BoardPose(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Pose T_CB;
  T_CB.R = ExpRotation({0.5 * u(random), 0.5 * u(random), 0.6 * u(random)});
  const Eigen::Vector3d at = DrawVector<3>(u, random);
  T_CB.p = Eigen::Vector3d(0.012 * at.x(), 0.008 * at.y(), kDistance_m * (1 + 0.12 * at.z())) -
           T_CB.R * (kSquare_m * Eigen::Vector3d(3.5, 2.5, 0));
  return T_CB;
}

/// The collar near the middle of the picture, leaning away by `lean`.
Pose CollarPose(const Pose& T_RC, double lean, double roll, const Eigen::Vector3d& middle_C) {
  const Eigen::Vector3d d = Eigen::Vector3d(-std::cos(lean), 0.2, std::sin(lean)).normalized();
  const Eigen::Vector3d out = (-Eigen::Vector3d::UnitZ() + d.z() * d).normalized();
  Pose T_CE;
  T_CE.R << d, out, d.cross(out);
  T_CE.R = T_CE.R * ExpRotation({roll, 0, 0});
  T_CE.p = middle_C + 0.015 * d;
  return T_RC * T_CE;
}

simulation::ShaftCurve StraightShaft(const Pose& T_RE) {
  simulation::ShaftCurve curve;
  curve.diameter_m = 0.005;
  curve.T_RE = T_RE;
  for (int i = 20; i >= 0; --i) curve.points.push_back(T_RE * Eigen::Vector3d(-0.01 * i, 0, 0));
  return curve;
}

Eigen::Vector3d Draw(double sd, std::mt19937& random) {
  std::normal_distribution<double> normal(0, sd);
  return {normal(random), normal(random), normal(random)};
}

TimeNs TimeOf(std::size_t frame) { return static_cast<TimeNs>(frame) * kPeriod_ns; }

Recording SetUp(const CameraCalibration& camera, std::size_t frames) {
  Recording recording;
  recording.instrument = {0.4, 0.005, 0.3, 0.0};
  recording.p_RP = {0.2, 0, 0};
  CameraStream& stream = recording.cam0.emplace();
  stream.calibration = camera;
  for (std::size_t i = 0; i < frames; ++i) {
    stream.filenames.push_back({TimeOf(i), fmt::format("{}.png", i)});
  }
  return recording;
}

}  // namespace

const char* ChainScene::Board() { return "chessboard:8x6:0.005"; }

ChainScene::ChainScene(const Counts& counts)
    : counts_(counts), camera_(Camera()), collar_(Collar()), p_E_(0.0083, -0.0006, 0.0004) {
  DrawCollars();
}

void ChainScene::DrawCollars() {
  simulation::LaparoscopeOptions options;
  options.tissue.point_R = camera_.T_RC * Eigen::Vector3d(0, 0, 0.16);
  options.tissue.normal_R = camera_.T_RC.R * Eigen::Vector3d(0.2, -0.3, -1);
  options.exposure_distance_m = kDistance_m;
  options.exposure = 0.5;
  options.grey = true;
  options.parts_per_px = 2;
  const simulation::Laparoscope scope(camera_, collar_, options);
  const auto draw = [&](const Pose& T_RE, std::vector<ChainView>& views) {
    views.push_back({scope.RenderLight(StraightShaft(T_RE), 0), T_RE});
  };
  const Eigen::Vector3d middle_C(0, 0, kDistance_m);
  const Eigen::Vector3d divot = CollarPose(camera_.T_RC, 0.35, 0.2, middle_C) * p_E_;
  for (int i = 0; i < counts_.tip; ++i) {
    const double a = 2 * std::numbers::pi * i / counts_.tip;
    Pose T_RE = CollarPose(camera_.T_RC, 0.35 + 0.35 * std::cos(a), 0.2 + 0.4 * std::sin(a + 0.7),
                           middle_C);
    T_RE.R = ExpRotation(0.4 * std::sin(a) * camera_.T_RC.R.col(2)) * T_RE.R;
    T_RE.p = divot - T_RE.R * p_E_;
    draw(T_RE, tip_);
  }
  for (int i = 0; i < counts_.work; ++i) {
    const double a = 2 * std::numbers::pi * i / counts_.work;
    draw(CollarPose(camera_.T_RC, 0.3 + 0.2 * std::sin(a), 0.15 * std::cos(2 * a),
                    middle_C + Eigen::Vector3d(0.012 * std::cos(a), 0.008 * std::sin(a),
                                               0.01 * std::sin(a + 1))),
         work_);
  }
}

void ChainScene::WriteLens(const fs::path& folder, std::mt19937& random) const {
  const CameraModel model(camera_);
  fs::create_directories(folder);
  for (int i = 0; i < counts_.lens; ++i) {
    WriteFilm(folder / fmt::format("{:02}.png", i), DrawBoard(model, BoardPose(random)),
              *camera_.gamma, random);
  }
}

void ChainScene::WriteHandEye(const fs::path& folder, std::mt19937& random) const {
  const CameraModel model(camera_);
  const Pose T_WB{ExpRotation({-0.8, 0.5, 1.1}), {0.08, 0.03, -0.05}};
  Recording recording = SetUp(camera_, static_cast<std::size_t>(counts_.hand_eye));
  recording.cam0->calibration.T_RC = Pose();  // which is what is sought
  WristStream& wrist = recording.wrist0.emplace();
  wrist.rate_hz = 25;
  wrist.position_noise_m = kWristPosition_m;
  wrist.orientation_noise_rad = kWristTurn_rad;
  fs::create_directories(folder / "cam0/data");
  for (int i = 0; i < counts_.hand_eye; ++i) {
    const Pose T_CB = BoardPose(random), T_RW = camera_.T_RC * T_CB * T_WB.Inverse();
    const Eigen::Matrix3d R = ExpRotation(Draw(kWristTurn_rad, random)) * T_RW.R;
    wrist.samples.push_back({TimeOf(static_cast<std::size_t>(i)),
                             {T_RW.p + Draw(kWristPosition_m, random), Eigen::Quaterniond(R)}});
    WriteFilm(folder / fmt::format("cam0/data/{}.png", i), DrawBoard(model, T_CB), *camera_.gamma,
              random);
  }
  WriteRecording(folder, recording);
}

void ChainScene::WriteCollar(const fs::path& folder, const std::vector<ChainView>& views,
                             std::mt19937& random) const {
  Recording recording = SetUp(camera_, views.size());
  recording.tags0 = collar_;
  fs::create_directories(folder / "cam0/data");
  for (std::size_t i = 0; i < views.size(); ++i) {
    WriteFilm(folder / fmt::format("cam0/data/{}.png", i), views[i].light, *camera_.gamma, random);
  }
  WriteRecording(folder, recording);
}

void ChainScene::WriteTip(const fs::path& folder, std::mt19937& random) const {
  WriteCollar(folder, tip_, random);
}

void ChainScene::WriteWork(const fs::path& folder, std::mt19937& random) const {
  WriteCollar(folder, work_, random);
}

std::vector<Eigen::Vector3d> ChainScene::Tips() const {
  std::vector<Eigen::Vector3d> tips;
  for (const ChainView& view : work_) tips.push_back(view.T_RE * p_E_);
  return tips;
}

std::vector<TimeNs> ChainScene::WorkTimes() const {
  std::vector<TimeNs> times;
  for (std::size_t i = 0; i < work_.size(); ++i) times.push_back(TimeOf(i));
  return times;
}

}  // namespace flextip::bench
