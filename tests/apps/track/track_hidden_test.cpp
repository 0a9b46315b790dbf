// flextip track where the tip hides for a while: with the wrist, without it, with a second eye.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "simulation/render/laparoscope.h"
#include "tests/apps/run_program.h"
#include "tests/simulation/render_test_scene.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 26, kFirstHidden = 9, kFirstBack = 18;
constexpr double kLength_m = 0.6;
constexpr TimeNs kPeriod_ns = 40'000'000;

bool IsHidden(int i) { return i >= kFirstHidden && i < kFirstBack; }

/// A straight shaft through a port, moved across the view; in the frames of the middle there is
/// nothing but grey.
class TrackHidden : public testing::Test {
 protected:
  static CameraCalibration Camera(double right_m = 0.0) {
    CameraCalibration camera = render_test::SmallCamera();
    camera.fu_px = camera.fv_px = 420;
    camera.rate_hz = 25;
    camera.T_RC.p.x() = right_m;
    return camera;
  }
  static Pose Tip(int i) {
    const Eigen::Matrix3d R_0 = ExpRotation({0.05, 0.3, -0.2}) * ExpRotation({-1.2, 0, 0});
    const Eigen::Vector3d p_0(0.03, 0.002, 0.055);
    const Eigen::Vector3d p = p_0 + i * Eigen::Vector3d(2e-4, -1.5e-4, 1e-4);
    const Eigen::Vector3d d = (p - Port()).normalized();
    return {RotationWithoutTwist(R_0.col(0), d) * R_0, p};
  }
  static Eigen::Vector3d Port() {
    const Eigen::Matrix3d R_0 = ExpRotation({0.05, 0.3, -0.2}) * ExpRotation({-1.2, 0, 0});
    return Eigen::Vector3d(0.03, 0.002, 0.055) - 0.3 * R_0.col(0);
  }

  static std::vector<cv::Mat> Render(const CameraCalibration& camera, bool hidden) {
    simulation::LaparoscopeOptions o = render_test::PlainOptions();
    o.blur_sigma_px = 0.7;
    o.exposure = 0.2;
    o.exposure_distance_m = 0.06;
    simulation::Laparoscope scope(camera, render_test::HexagonCollar(), o);
    std::vector<cv::Mat> pictures;
    for (int i = 0; i < kFrames; ++i) {
      if (hidden && IsHidden(i)) {
        pictures.emplace_back(camera.height_px, camera.width_px, CV_8UC3,
                              cv::Scalar(120, 120, 120));
        continue;
      }
      const Image image = scope.Render(render_test::ArcShaft(Tip(i), 0.1, 1e3, 0.005), i);
      pictures.push_back(cv::Mat(image.height_px, image.width_px, CV_8UC3,
                                 const_cast<std::uint8_t*>(image.data.data()))
                             .clone());
    }
    return pictures;
  }

  /// Wrist poses by their stated noise.
  static WristStream Wrist() {
    WristStream wrist;
    wrist.rate_hz = 25;
    wrist.position_noise_m = 5e-5;
    wrist.orientation_noise_rad = 3e-4;
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    const auto noise = [&](double sd) -> Eigen::Vector3d {
      return sd * DrawVector<3>(normal, random);
    };
    for (int i = -1; i <= kFrames; ++i) {
      const Pose T_RE = Tip(i);
      WristSample sample;
      sample.p_RW = T_RE.p - kLength_m * T_RE.R.col(0) + noise(wrist.position_noise_m);
      sample.q_RW = Eigen::Quaterniond(ExpRotation(noise(wrist.orientation_noise_rad)) * T_RE.R);
      wrist.samples.push_back({(i + 1) * kPeriod_ns, sample});
    }
    return wrist;
  }

  Recording Base() const {
    Recording recording;
    recording.instrument = {kLength_m, 0.005, 0.3, 0.0};
    recording.p_RP = Port();
    recording.tags0 = render_test::HexagonCollar();
    return recording;
  }
  /// The stream of a camera whose pictures are saved; `every` frame but `left_out`.
  CameraStream Save(const std::string& name, const CameraCalibration& camera,
                    const std::vector<cv::Mat>& pictures, TimeNs late_ns = 0, int left_out = -1) {
    CameraStream stream;
    stream.calibration = camera;
    fs::create_directories(folder_ / ("rec/" + name + "/data"));
    for (int i = 0; i < kFrames; ++i) {
      if (i == left_out) continue;
      stream.filenames.push_back({(i + 1) * kPeriod_ns + late_ns, fmt::format("{}.png", i)});
      EXPECT_TRUE(cv::imwrite((folder_ / fmt::format("rec/{}/data/{}.png", name, i)).string(),
                              pictures[i]));
    }
    return stream;
  }
  /// Tracks RECORDING and gives the tips.
  Series<TipObservation> Track(const std::string& out, std::vector<std::string> more = {}) {
    std::string truth = "#timestamp [ns],x,y,z\n";
    for (int i = 0; i < kFrames; ++i) {
      const Eigen::Vector3d p = Tip(i).p;
      truth += fmt::format("{},{},{},{}\n", (i + 1) * kPeriod_ns, p.x(), p.y(), p.z());
    }
    std::vector<std::string> arguments{"track",   (folder_ / "rec").string(),
                                       "-o",      (folder_ / out).string(),
                                       "--truth", folder_.Write("truth.csv", truth)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    fs::copy(folder_ / (out + "/vision0"), folder_ / "rec/vision0");
    auto tips = ReadRecording(folder_ / "rec").recording.vision0->tips;
    fs::remove_all(folder_ / "rec/vision0");
    return tips;
  }
  nlohmann::json Summary(const std::string& out) const {
    return nlohmann::json::parse(ReadText(folder_ / (out + "/summary.json")));
  }

  TestFolder folder_;
};

TEST_F(TrackHidden, IsCarriedOnByTheWristAndComesBack) {
  Recording recording = Base();
  recording.wrist0 = Wrist();
  recording.cam0 = Save("cam0", Camera(), Render(Camera(), true));
  WriteRecording(folder_ / "rec", recording);
  const auto tips = Track("a");
  ASSERT_EQ(tips.size(), kFrames);
  double before_m2 = 0.0;
  for (int i = 0; i < kFrames; ++i) {
    const TipObservation& tip = tips[i].value;
    EXPECT_EQ(tip.status, IsHidden(i) ? TipStatus::kPredicted : TipStatus::kOk) << i;
    if (tip.status == TipStatus::kLost) continue;
    const Eigen::Vector3d e = tip.p_RE - Tip(i).p;
    EXPECT_LT(MahalanobisSquared(e, tip.covariance_m2), 16.3) << i;  // 99.9 %
    if (IsHidden(i)) {
      EXPECT_GT(tip.covariance_m2.trace(), before_m2) << i;
    }
    before_m2 = tip.covariance_m2.trace();
  }
  const auto summary = Summary("a");
  EXPECT_EQ(summary["predicted"], kFirstBack - kFirstHidden);
  EXPECT_EQ(summary["scored_frames_predicted"], kFirstBack - kFirstHidden);
  EXPECT_EQ(summary["scored_frames"], kFrames - (kFirstBack - kFirstHidden));
  EXPECT_EQ(summary["frames_by_pixels"].get<int>() + summary["frames_by_corners"].get<int>(),
            summary["ok"].get<int>());
  EXPECT_GE(summary["predicted_tip_share_inside_95"], 0.7);
  EXPECT_LT(summary["predicted_tip_mean_nees"], 7.815);

  // By its motion alone it is carried on for three frames.
  const auto blind = Track("b", {"--no-model"});
  for (int i = 0; i < kFrames; ++i) {
    const auto expected = !IsHidden(i)           ? TipStatus::kOk
                          : i < kFirstHidden + 3 ? TipStatus::kPredicted
                                                 : TipStatus::kLost;
    EXPECT_EQ(blind[i].value.status, expected) << i;
  }
  EXPECT_EQ(Summary("b")["lost"], kFirstBack - kFirstHidden - 3);
}

TEST_F(TrackHidden, TheOtherEyeStillSeesIt) {
  Recording recording = Base();
  recording.cam0 = Save("cam0", Camera(), Render(Camera(), true));
  recording.cam1 = Save("cam1", Camera(0.004), Render(Camera(0.004), false), 1'000'000, 3);
  WriteRecording(folder_ / "rec", recording);
  const auto tips = Track("a");
  ASSERT_EQ(tips.size(), kFrames);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(tips[i].t_ns, (i + 1) * kPeriod_ns);
    EXPECT_EQ(tips[i].value.status, TipStatus::kOk) << i;
    EXPECT_LT((tips[i].value.p_RE - Tip(i).p).norm(), 3e-4) << i;
  }
  EXPECT_EQ(Summary("a")["cameras"], 2);
  EXPECT_EQ(Summary("a")["ok"], kFrames);
}

// The same frames to and fro, long enough that the tables outgrow every other file.
TEST_F(TrackHidden, AKilledRunWithAWristIsResumedToTheSameTables) {
  constexpr int kLong = 260;
  Recording recording = Base();
  const WristStream once = Wrist();
  recording.wrist0 = once;
  recording.wrist0->samples.clear();
  recording.cam0 = Save("cam0", Camera(), Render(Camera(), true));
  recording.cam0->filenames.clear();
  recording.cam1 = Save("cam1", Camera(0.004), Render(Camera(0.004), true));
  recording.cam1->filenames.clear();
  for (int i = -1; i <= kLong; ++i) {
    const int at = std::max(0, i) % (2 * kFrames - 2), frame = std::min(at, 2 * kFrames - 2 - at);
    const TimeNs t_ns = (i + 1) * kPeriod_ns;
    recording.wrist0->samples.push_back({t_ns, once.samples[frame + 1].value});
    if (i < 0 || i == kLong) continue;
    recording.cam0->filenames.push_back({t_ns, fmt::format("{}.png", frame)});
    if (i % 7 != 3) recording.cam1->filenames.push_back({t_ns, fmt::format("{}.png", frame)});
  }
  WriteRecording(folder_ / "rec", recording);
  Track("whole");
  const auto rec = (folder_ / "rec").string(), out = (folder_ / "out").string();
  KillAtFileSize({"track", rec, "-o", out, "--truth", (folder_ / "truth.csv").string()},
                 fs::file_size(folder_ / "whole/tags0/data.csv") * 3 / 4);
  ASSERT_FALSE(fs::exists(out));
  Track("out", {"--resume"});
  EXPECT_THAT(Summary("out")["warnings"].dump(), testing::HasSubstr("resumed"));
  for (const char* file : {"vision0/data.csv", "tags0/data.csv", "frames.csv"}) {
    EXPECT_EQ(ReadText(folder_ / "out" / file), ReadText(folder_ / "whole" / file)) << file;
  }
}

}  // namespace
}  // namespace flextip
