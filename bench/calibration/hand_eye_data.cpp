#include "bench/calibration/hand_eye_data.h"

#include <fmt/format.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "calibration/camera/camera_calibration.h"
#include "core/draw_vector.h"
#include "core/error.h"
#include "core/rotation.h"
#include "recording/recording_writer.h"
#include "vision/camera_model.h"

namespace flextip::bench {
namespace {

namespace fs = std::filesystem;
constexpr int kMostViews = 1000;
constexpr TimeNs kBetweenViews_ns = 1'000'000'000;

std::vector<double> Numbers(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError::At(file.string(), 0, "cannot be read");
  std::vector<double> numbers;
  for (double value = 0; stream >> value;) numbers.push_back(value);
  return numbers;
}

Pose PoseInMm(const fs::path& file) {
  const auto n = Numbers(file);
  if (n.size() != 16) throw InputError::At(file.string(), 0, "expected sixteen numbers");
  Pose T;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.R(row, column) = n[4 * row + column];
    T.p[row] = 1e-3 * n[4 * row + 3];
  }
  T.R = Eigen::Quaterniond(T.R).normalized().toRotationMatrix();  // six digits in the file
  return T;
}

CameraCalibration ScopeCamera(const fs::path& folder, int width_px, int height_px) {
  const auto n = Numbers(folder / "calib.left.intrinsics.txt");
  if (n.size() != 14) throw InputError("calib.left.intrinsics.txt: expected fourteen numbers");
  CameraCalibration camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fu_px = n[0];
  camera.cu_px = n[2];
  camera.fv_px = n[4];
  camera.cv_px = n[5];
  camera.distortion = Distortion::kOpenCv;
  camera.distortion_coefficients.assign(n.begin() + 9, n.end());
  camera.rate_hz = 1;
  return camera;
}

std::string PictureName(int i) { return fmt::format("calib.left.images.{}.gray.png", i); }

Image ReadGrey(const fs::path& file) {
  const cv::Mat_<std::uint8_t> picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw InputError::At(file.string(), 0, "cannot be read");
  Image image(picture.cols, picture.rows, 1);
  std::copy(picture.begin(), picture.end(), image.data.begin());
  return image;
}

WristStream ScopeWrist(const fs::path& folder, int views, double orientation_noise_rad,
                       double position_noise_m) {
  WristStream wrist{"optical tracker: the board's marker in the scope's",
                    1.0,
                    position_noise_m,
                    orientation_noise_rad,
                    {}};
  for (int i = 0; i < views; ++i) {
    const Pose T_RW = PoseInMm(folder / fmt::format("calib.device_tracking.{}.txt", i)).Inverse() *
                      PoseInMm(folder / fmt::format("calib.calib_obj_tracking.{}.txt", i));
    wrist.samples.push_back({i * kBetweenViews_ns, {T_RW.p, T_RW.Quaternion()}});
  }
  return wrist;
}

int CountViews(const fs::path& folder) {
  int views = 0;
  while (views < kMostViews && fs::exists(folder / PictureName(views))) ++views;
  return views;
}

// Adds the inset's corners to the board's.
void Join(const BoardSpec& board, const BoardSpec& inset, const BoardSighting& from,
          BoardSighting& to) {
  constexpr int kFirstId = 10000;
  const auto middle = [](const BoardSpec& spec) -> Eigen::Vector2d {
    const auto [low, high] = BoardExtent(spec);
    return 0.5 * (low + high);
  };
  const Eigen::Vector2d to_middle = middle(board), from_middle = middle(inset);
  for (std::size_t i = 0; i < from.px.size(); ++i) {
    const Eigen::Vector2d x = from.x_B[i].head<2>() - from_middle;
    to.ids.push_back(kFirstId + from.ids[i]);
    to.x_B.emplace_back(to_middle.x() + x.y(), to_middle.y() - x.x(), 0.0);
    to.px.push_back(from.px[i]);
  }
}

}  // namespace

HandEyeInput ReadTrackedScope(const fs::path& folder, const BoardSpec& board,
                              const std::optional<BoardSpec>& inset, double orientation_noise_rad,
                              double position_noise_m) {
  HandEyeInput input;
  const int views = CountViews(folder);
  input.wrist = ScopeWrist(folder, views, orientation_noise_rad, position_noise_m);
  for (int i = 0; i < views; ++i) {
    const Image image = ReadGrey(folder / PictureName(i));
    if (i == 0) input.camera = ScopeCamera(folder, image.width_px, image.height_px);
    BoardSighting seen = DetectBoard(image, board);
    if (inset) Join(board, *inset, DetectBoard(image, *inset), seen);
    input.views.push_back({std::to_string(i), i * kBetweenViews_ns, seen});
  }
  return input;
}

void FitScopeCamera(const BoardSpec& board, HandEyeInput& input) {
  std::vector<BoardView> views;
  for (const HandEyeView& view : input.views) views.push_back({view.name, view.sighting});
  CameraCalibrationOptions options;
  options.lens = LensModel{Distortion::kOpenCv, 5};
  options.warp = false;
  const auto found =
      CalibrateCamera(views, input.camera.width_px, input.camera.height_px, board, options);
  if (!found.IsUsable()) throw WorkError(found.message);
  input.camera = found.solution.camera;
}

void WriteTrackedScope(const fs::path& folder, const fs::path& recording,
                       double orientation_noise_rad, double position_noise_m) {
  const int views = CountViews(folder);
  const Image first = ReadGrey(folder / PictureName(0));
  Recording r;
  r.instrument = {0.3, 0.01, 1.0, 0.0};  // a recording has one; nothing here reads it
  r.wrist0 = ScopeWrist(folder, views, orientation_noise_rad, position_noise_m);
  r.cam0.emplace().calibration = ScopeCamera(folder, first.width_px, first.height_px);
  fs::create_directories(recording / "cam0/data");
  for (int i = 0; i < views; ++i) {
    r.cam0->filenames.push_back({i * kBetweenViews_ns, PictureName(i)});
    fs::copy_file(folder / PictureName(i), recording / "cam0/data" / PictureName(i),
                  fs::copy_options::overwrite_existing);
  }
  WriteRecording(recording, r);
}

FarBoards MakeFarBoards(int views, double distance_m, double tilt_rad, double corner_noise_px,
                        unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> u(-1, 1);
  const auto noise = [&](double sd) -> Eigen::Vector3d {
    return sd * DrawVector<3>(normal, random);
  };
  FarBoards far;
  HandEyeInput& input = far.input;
  CameraCalibration& c = input.camera;
  c.width_px = 1280;
  c.height_px = 960;
  c.fu_px = c.fv_px = 1100;
  c.cu_px = 640;
  c.cv_px = 480;
  input.wrist.rate_hz = 1;
  input.wrist.orientation_noise_rad = 1e-3;
  input.wrist.position_noise_m = 2e-4;
  far.T_FC = {ExpRotation({0.4, -2.1, 0.9}), {0.5, -0.1, 0.35}};
  far.T_KB = {ExpRotation({-0.8, 0.5, 1.1}), {0.12, 0.03, -0.05}};
  const CameraModel model(c);
  for (int i = 0; i < views; ++i) {
    Pose T_CB;
    T_CB.R = ExpRotation({tilt_rad * u(random), tilt_rad * u(random), tilt_rad * u(random)});
    const Eigen::Vector3d at = DrawVector<3>(u, random);
    T_CB.p = distance_m * Eigen::Vector3d(0.3 * at.x(), 0.2 * at.y(), 1 + 0.2 * at.z());
    const Pose T_RW = far.T_FC * T_CB * far.T_KB.Inverse();
    const Eigen::Matrix3d R = ExpRotation(noise(1e-3)) * T_RW.R;
    const TimeNs t_ns = i * kBetweenViews_ns;
    input.wrist.samples.push_back({t_ns, {T_RW.p + noise(2e-4), Eigen::Quaterniond(R)}});
    HandEyeView view{std::to_string(i), t_ns, {}};
    for (int k = 0; k < 24; ++k) {
      view.sighting.ids.push_back(k);
      const int row = k / 6, column = k % 6;
      view.sighting.x_B.emplace_back(0.006 * column - 0.015, 0.006 * row - 0.009, 0);
      view.sighting.px.emplace_back(model.Project(T_CB * view.sighting.x_B.back()).value() +
                                    noise(corner_noise_px).head<2>());
    }
    input.views.push_back(view);
  }
  return far;
}

}  // namespace flextip::bench
