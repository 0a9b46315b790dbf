// What flextip calibrate wrote, given to track and to calibrate budget: rendered pictures of a
// collar by two cameras of which the recording says nothing true.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/rotation.h"
#include "recording/calibrations/file.h"
#include "recording/recording_writer.h"
#include "recording/streams/sensor_streams.h"
#include "simulation/render/laparoscope.h"
#include "tests/apps/run_program.h"
#include "tests/simulation/render_test_scene.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kFrames = 3;
const Pose kT_RC{ExpRotation({0.3, -2.0, 0.7}), {0.4, 0.1, 0.3}};
const Pose kT_C0C1{ExpRotation({0, -0.06, 0.01}), {0.006, 0.0003, -0.0004}};

Calibration OfKind(const std::string& kind) {
  Calibration calibration;
  calibration.kind = kind;
  return calibration;
}

class CalibrationUsed : public testing::Test {
 protected:
  static CameraCalibration TrueCamera(int eye) {
    CameraCalibration camera = render_test::SmallCamera();
    camera.fu_px = camera.fv_px = 420 - 10 * eye;
    camera.distortion_coefficients = {-0.12, 0.05, 0.002, -0.001};
    if (eye == 0) camera.distortion = Distortion::kEquidistant;
    camera.T_RC = eye == 0 ? kT_RC : kT_RC * kT_C0C1;
    camera.rate_hz = 25;
    return camera;
  }
  static CameraCalibration SaidCamera() {
    CameraCalibration camera = render_test::SmallCamera();
    camera.fu_px = camera.fv_px = 380;
    camera.rate_hz = 25;
    return camera;
  }
  static Pose TruePose(int i) {
    Pose T_CE;
    T_CE.R = ExpRotation({0.05, 0.3, -0.2}) * ExpRotation({-1.2, 0, 0});
    T_CE.p = {0.03 + 0.0005 * i, 0.002, 0.055};
    return kT_RC * T_CE;
  }

  static void SetUpTestSuite() {
    simulation::LaparoscopeOptions options = render_test::PlainOptions();
    options.tissue.point_R = kT_RC * options.tissue.point_R;
    options.tissue.normal_R = kT_RC.R * options.tissue.normal_R;
    options.blur_sigma_px = 0.7;
    options.exposure = 0.2;
    options.exposure_distance_m = 0.06;
    for (int eye = 0; eye < 2; ++eye) {
      simulation::Laparoscope scope(TrueCamera(eye), render_test::HexagonCollar(), options);
      for (int i = 0; i < kFrames; ++i) {
        const Image image = scope.Render(render_test::ArcShaft(TruePose(i), 0.1, 0.9, 0.005), i);
        pictures_.push_back(cv::Mat(image.height_px, image.width_px, CV_8UC3,
                                    const_cast<std::uint8_t*>(image.data.data()))
                                .clone());
      }
    }
  }
  static void TearDownTestSuite() { pictures_.clear(); }

  void SetUp() override {
    Record("mono", 1);
    Calibration lens = OfKind("camera");
    AddLens("cam0", TrueCamera(0), lens);
    lens.covariance = 1e-8 * Eigen::MatrixXd::Identity(8, 8);
    lens.covariance.bottomRightCorner<4, 4>() = Eigen::Matrix4d::Identity();
    lens_ = Write("lens", lens);
    Calibration hand_eye = OfKind("hand-eye");
    hand_eye.poses["cam0.T_RC"] = kT_RC;
    hand_eye.poses["tags0.T_WE"] = Pose();
    hand_eye.covariance = Eigen::MatrixXd::Zero(12, 12);
    hand_eye.covariance.block<3, 3>(3, 3) = 4e-8 * Eigen::Matrix3d::Identity();  // 0.2 mm
    hand_eye_ = Write("hand_eye", hand_eye);
    Calibration stereo = OfKind("stereo");
    stereo.poses["cam1.T_C0C1"] = kT_C0C1;
    for (int eye = 0; eye < 2; ++eye) AddLens(fmt::format("cam{}", eye), TrueCamera(eye), stereo);
    stereo_ = Write("stereo", stereo);
    Calibration tip = OfKind("tip");
    tip.numbers["tags0.p_E"] = {0, 0, 0};
    tip.covariance = 9e-8 * Eigen::Matrix3d::Identity();  // 0.3 mm
    tip_ = Write("tip", tip);
  }

  void Record(const std::string& name, int eyes) const {
    Recording recording;
    recording.instrument = {0.6, 0.005, 0.3, 0.0};
    recording.p_RP = {0.28, 0, 0};
    recording.tags0 = render_test::HexagonCollar();
    for (int eye = 0; eye < eyes; ++eye) {
      CameraStream& camera = (eye == 0 ? recording.cam0 : recording.cam1).emplace();
      camera.calibration = SaidCamera();
      for (int i = 0; i < kFrames; ++i) {
        camera.filenames.push_back({i * 40'000'000, fmt::format("{}.png", i)});
      }
    }
    fs::create_directories(folder_ / name);
    WriteRecording(folder_ / name, recording);
    for (int eye = 0; eye < eyes; ++eye) {
      const fs::path data = folder_ / fmt::format("{}/cam{}/data", name, eye);
      fs::create_directories(data);
      for (int i = 0; i < kFrames; ++i) {
        ASSERT_TRUE(
            cv::imwrite((data / fmt::format("{}.png", i)).string(), pictures_[eye * kFrames + i]));
      }
    }
  }
  std::string Write(const std::string& name, const Calibration& calibration) const {
    const fs::path file = folder_ / (name + ".yaml");
    WriteCalibration(file, calibration);
    return file.string();
  }
  ProgramResult Run(std::vector<std::string> command, const std::string& recording,
                    const std::vector<std::string>& files) {
    command.insert(command.end(),
                   {(folder_ / recording).string(), "-o", (folder_ / "out").string(), "--force"});
    for (const std::string& file : files) command.insert(command.end(), {"--calibration", file});
    return RunProgram(command);
  }
  /// The tips that `track` finds; they must all be there.
  std::vector<TipObservation> Track(const std::string& recording,
                                    const std::vector<std::string>& files) {
    const auto run = Run({"track"}, recording, files);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    ReadLog log;
    std::vector<TipObservation> tips;
    for (const auto& tip : ReadVision(folder_ / "out/vision0", log).tips) {
      EXPECT_EQ(tip.value.status, TipStatus::kOk);
      tips.push_back(tip.value);
    }
    EXPECT_EQ(tips.size(), static_cast<std::size_t>(kFrames));
    return tips;
  }
  static double LargestError(const std::vector<TipObservation>& tips) {
    double largest = 0;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      largest = std::max(largest, (tips[i].p_RE - TruePose(static_cast<int>(i)).p).norm());
    }
    return largest;
  }
  nlohmann::json Summary() const {
    return nlohmann::json::parse(ReadText(folder_ / "out/summary.json"));
  }

  static std::vector<cv::Mat> pictures_;
  TestFolder folder_;
  std::string lens_, hand_eye_, stereo_, tip_;
};
std::vector<cv::Mat> CalibrationUsed::pictures_;

TEST_F(CalibrationUsed, TrackFindsTheTipWithLensAndHandEye) {
  EXPECT_GT(LargestError(Track("mono", {hand_eye_})), 2e-3);  // with the lens recorded
  EXPECT_LT(LargestError(Track("mono", {lens_, hand_eye_})), 4e-4);
  const auto used = Summary()["calibrations"];
  ASSERT_EQ(used.size(), 2u);
  EXPECT_EQ(used[0]["kind"], "camera");
  EXPECT_THAT(used[0]["names"], ElementsAre("cam0.distortion_coefficients", "cam0.intrinsics",
                                            "cam0.distortion_model"));
  EXPECT_THAT(used[1]["names"], ElementsAre("cam0.T_RC"));
}

TEST_F(CalibrationUsed, TrackTakesStereoAndHandEyeInEitherOrder) {
  Record("stereo", 2);
  const auto first = Track("stereo", {stereo_, hand_eye_});
  EXPECT_LT(LargestError(first), 2e-4);
  EXPECT_EQ(Summary()["cameras"], 2);
  EXPECT_THAT(Summary()["calibrations"][0]["names"], testing::Contains("cam1.T_C0C1"));
  const auto last = Track("stereo", {hand_eye_, stereo_});
  for (int i = 0; i < kFrames; ++i) EXPECT_LT((first[i].p_RE - last[i].p_RE).norm(), 1e-9);
  // Two eyes see depth better than one.
  const auto mono = Track("mono", {lens_, hand_eye_});
  EXPECT_LT(first[0].covariance_m2.trace(), 0.5 * mono[0].covariance_m2.trace());
}

TEST_F(CalibrationUsed, TheTipOnTheCollarMovesTheTipTracked) {
  const auto before = Track("mono", {lens_, hand_eye_});
  Calibration moved = OfKind("tip");
  moved.numbers["tags0.p_E"] = {0.002, -0.001, 0.003};
  const auto after = Track("mono", {lens_, hand_eye_, Write("moved", moved)});
  for (int i = 0; i < kFrames; ++i) {
    const Eigen::Vector3d shift = TruePose(i).R * Eigen::Vector3d(0.002, -0.001, 0.003);
    EXPECT_LT((after[i].p_RE - before[i].p_RE - shift).norm(), 2e-4);
  }
}

TEST_F(CalibrationUsed, RefusesWhatTheRecordingHasNotAndWhatIsBroken) {
  const auto refused = [&](const Calibration& calibration, const std::vector<std::string>& parts) {
    return IsRefused(Run({"track"}, "mono", {Write("bad", calibration)}), parts);
  };
  Calibration strain = OfKind("strain");
  strain.numbers["strain0.moment_noise_Nm"] = {0.1};
  EXPECT_TRUE(refused(strain, {"bad.yaml", "strain0"}));
  Calibration in_hand = OfKind("hand-eye");
  in_hand.poses["cam0.T_WC"] = Pose();
  EXPECT_TRUE(refused(in_hand, {"bad.yaml", "cam0.T_WC", "moves with the wrist"}));
  Calibration lens = OfKind("camera");
  AddLens("cam0", TrueCamera(0), lens);
  lens.numbers["cam0.distortion_coefficients"].push_back(0);
  EXPECT_TRUE(refused(lens, {"bad.yaml", "cam0.distortion_coefficients", "found 5"}));
  EXPECT_TRUE(IsRefused(Run({"track"}, "mono", {stereo_}),
                        {"stereo.yaml", "cam1.T_C0C1", "the recording has no cam1"}));
  EXPECT_TRUE(IsRefused(Run({"calibrate", "budget"}, "mono", {Write("bad", strain)}),
                        {"bad.yaml", "strain0"}));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

const nlohmann::json& Part(const nlohmann::json& summary, const std::string& name) {
  static const nlohmann::json none;
  for (const auto& part : summary["parts"]) {
    if (part["part"] == name) return part;
  }
  ADD_FAILURE() << "no part " << name << " in " << summary["parts"].dump();
  return none;
}

TEST_F(CalibrationUsed, TheBudgetSaysWhatEachContributes) {
  const auto run =
      Run({"calibrate", "budget", "--tip-force", "0.1,0.2,0.3"}, "mono", {lens_, hand_eye_, tip_});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = Summary();
  EXPECT_EQ(summary["frames"], kFrames);
  // A shift without a turn, and an offset known alike along all axes, are themselves.
  for (const char* side : {"depth_mm", "across_mm"}) {
    EXPECT_NEAR(Part(summary, "hand-eye")[side].get<double>(), 0.2, 1e-6);
    EXPECT_NEAR(Part(summary, "tip offset")[side].get<double>(), 0.3, 1e-6);
  }
  // The line of sight meets the lens's middle: 1 px there is z / f across.
  EXPECT_NEAR(Part(summary, "lens")["across_mm"].get<double>(), 1e3 * 0.062 / 420, 0.08);
  double squares = 0;
  for (const char* name : {"pixels", "lens", "hand-eye", "tip offset", "bending"}) {
    squares += std::pow(Part(summary, name)["depth_mm"].get<double>(), 2);
  }
  EXPECT_NEAR(Part(summary, "total")["depth_mm"].get<double>(), std::sqrt(squares), 1e-9);
  ASSERT_EQ(summary["not_known"].size(), 1u);
  EXPECT_EQ(summary["not_known"][0]["part"], "stiffness");
  EXPECT_THAT(ReadText(folder_ / "out/budget.csv"), HasSubstr("hand-eye_depth [m]"));
  EXPECT_THAT(ReadText(folder_ / "out/report.html"), HasSubstr("What contributes"));
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
}

TEST_F(CalibrationUsed, TheBudgetNamesWhatIsNotKnownAndWhatIsNotSeen) {
  const auto run = Run({"calibrate", "budget"}, "mono", {hand_eye_});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::vector<std::string> missing;
  const auto summary = Summary();
  for (const auto& one : summary["not_known"]) missing.push_back(one["part"]);
  EXPECT_THAT(missing, ElementsAre("lens", "tip offset", "stiffness", "bending"));
  EXPECT_THAT(Summary()["warnings"].dump(), HasSubstr("flextip calibrate camera"));

  for (int i = 0; i < kFrames; ++i) {
    const fs::path picture = folder_ / fmt::format("mono/cam0/data/{}.png", i);
    ASSERT_TRUE(cv::imwrite(picture.string(), cv::Mat(240, 320, CV_8UC1, cv::Scalar(99))));
  }
  const auto blind = Run({"calibrate", "budget"}, "mono", {});
  EXPECT_EQ(blind.exit_code, 1);
  EXPECT_THAT(blind.err, HasSubstr("the collar is seen in no frame"));
  fs::remove_all(folder_ / "mono/tags0");
  EXPECT_TRUE(IsRefused(Run({"calibrate", "budget"}, "mono", {hand_eye_}), {"mono", "tags0"}));
}

}  // namespace
}  // namespace flextip
