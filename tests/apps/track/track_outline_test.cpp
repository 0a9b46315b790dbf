// flextip track --outline: another instrument covers the tags, the shaft's outline stays.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/rotation.h"
#include "recording/recording_writer.h"
#include "simulation/render/laparoscope.h"
#include "tests/apps/run_program.h"
#include "tests/simulation/render_test_scene.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 22, kFirstCovered = 5, kFirstBack = 18;
constexpr TimeNs kPeriod_ns = 40'000'000;

/// A recording without a wrist; the tip 5 mm from the picture's left, its shaft in from the right.
class TrackOutline : public testing::Test {
 protected:
  static CameraCalibration Camera() {
    CameraCalibration camera = render_test::SmallCamera();
    camera.fu_px = camera.fv_px = 420;
    camera.rate_hz = 25;
    return camera;
  }
  static Pose Tip(int i) {
    const double u = 0.15 * i;
    return {ExpRotation({0, 0, 0.1 + 0.02 * std::sin(u)}) * ExpRotation({0, M_PI - 0.2, 0}) *
                ExpRotation({0.3, 0, 0}),
            {-0.028 + 0.001 * std::sin(u), -0.002 + 0.0015 * std::sin(1.3 * u), 0.09}};
  }
  void SetUp() override {
    simulation::LaparoscopeOptions o = render_test::PlainOptions();
    o.tissue.texture_contrast = 1;
    o.blur_sigma_px = 0.7;
    o.full_well_electrons = 15000;
    o.exposure = 0.3;
    o.exposure_distance_m = 0.09;
    simulation::Occluder other;  // across the middle, where the collar is
    other.a_R = {0.001, -0.05, 0.06};
    other.b_R = {0.001, 0.05, 0.06};
    other.radius_m = 0.005;
    other.specular = 0.5;
    other.albedo_bgr = {0.2, 0.2, 0.2};
    other.first_frame = kFirstCovered;
    other.last_frame = kFirstBack - 1;
    o.occluders = {other};
    const simulation::Laparoscope scope(Camera(), render_test::HexagonCollar(), o);
    Recording recording;
    recording.instrument = {0.6, 0.005, 0.3, 0.0};
    recording.cam0.emplace().calibration = Camera();
    recording.tags0 = render_test::HexagonCollar();
    fs::create_directories(folder_ / "rec/cam0/data");
    std::string truth = "#timestamp [ns],x,y,z\n";
    for (int i = 0; i < kFrames; ++i) {
      const auto name = fmt::format("{}.png", i);
      const TimeNs t_ns = (i + 1) * kPeriod_ns;
      const Image image = scope.Render(render_test::ArcShaft(Tip(i), 0.15, 5.0, 0.005), i);
      recording.cam0->filenames.push_back({t_ns, name});
      ASSERT_TRUE(cv::imwrite((folder_ / ("rec/cam0/data/" + name)).string(),
                              cv::Mat(image.height_px, image.width_px, CV_8UC3,
                                      const_cast<std::uint8_t*>(image.data.data()))));
      truth += fmt::format("{},{},{},{}\n", t_ns, Tip(i).p.x(), Tip(i).p.y(), Tip(i).p.z());
    }
    WriteRecording(folder_ / "rec", recording);
    folder_.Write("truth.csv", truth);
    recording_ = recording;
  }
  ProgramResult Track(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"track",   (folder_ / "rec").string(),
                                       "-o",      (folder_ / out).string(),
                                       "--truth", (folder_ / "truth.csv").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }
  nlohmann::json Summary(const std::string& out) const {
    return nlohmann::json::parse(ReadText(folder_ / (out + "/summary.json")));
  }
  TestFolder folder_;
  Recording recording_;
};

TEST_F(TrackOutline, CarriesTheTipWhileItsTagsAreCovered) {
  constexpr int kCovered = kFirstBack - kFirstCovered;
  const auto without = Track("a");
  ASSERT_EQ(without.exit_code, 0) << without.err;
  EXPECT_GE(Summary("a")["lost"], kCovered - 3);
  EXPECT_THAT(ReadText(folder_ / "a/frames.csv"), testing::Not(testing::HasSubstr("outline")));

  const auto with = Track("b", {"--outline", "round"});
  ASSERT_EQ(with.exit_code, 0) << with.err;
  const auto summary = Summary("b");
  EXPECT_EQ(summary["ok"], kFrames - kCovered);
  EXPECT_EQ(summary["predicted"], kCovered);
  EXPECT_EQ(summary["lost"], 0);
  EXPECT_LT(summary["predicted_tip_mean_nees"], 7.815);
  EXPECT_GE(summary["predicted_tip_share_inside_95"], 0.9);
  EXPECT_LT(summary["predicted_tip_max_error_m"], 3e-3);
  EXPECT_THAT(ReadText(folder_ / "b/frames.csv"), testing::HasSubstr("predicted,outline"));

  // A shaft that is not the one in the pictures changes nothing.
  const auto wrong = Track("c", {"--outline", "round", "--diameter", "0.0035"});
  ASSERT_EQ(wrong.exit_code, 0) << wrong.err;
  EXPECT_EQ(ReadText(folder_ / "c/vision0/data.csv"), ReadText(folder_ / "a/vision0/data.csv"));
}

// There and back, again and again, so that it is killed while the outline is followed or soon
// after.
TEST_F(TrackOutline, AKilledRunResumesAsIfItHadNotBeen) {
  constexpr int kLong = 400;
  recording_.cam0->filenames.clear();
  for (int i = 0; i < kLong; ++i) {
    const int at = i % (2 * kFrames - 2), frame = std::min(at, 2 * kFrames - 2 - at);
    recording_.cam0->filenames.push_back({(i + 1) * kPeriod_ns, fmt::format("{}.png", frame)});
  }
  WriteRecording(folder_ / "rec", recording_);
  const std::vector<std::string> how{"--outline", "round"};
  ASSERT_EQ(Track("whole", how).exit_code, 0);
  EXPECT_THAT(ReadText(folder_ / "whole/frames.csv"), testing::HasSubstr("predicted,outline"));
  const auto rec = (folder_ / "rec").string(), out = (folder_ / "out").string();
  const auto truth = (folder_ / "truth.csv").string();
  KillAtFileSize({"track", rec, "-o", out, "--truth", truth, "--outline", "round"},
                 fs::file_size(folder_ / "whole/vision0/data.csv") * 93 / 100);
  ASSERT_FALSE(fs::exists(out));
  const auto resumed = Track("out", {"--outline", "round", "--resume"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(Summary("out")["warnings"].dump(), testing::HasSubstr("resumed"));
  for (const char* file : {"vision0/data.csv", "tags0/data.csv", "frames.csv"}) {
    EXPECT_EQ(ReadText(folder_ / "out" / file), ReadText(folder_ / "whole" / file)) << file;
  }
}

TEST_F(TrackOutline, AsksForWhatItMustKnow) {
  EXPECT_TRUE(IsRefused(Track("a", {"--outline", "square"}), {"--outline", "square"}));
  EXPECT_TRUE(IsRefused(Track("a", {"--diameter", "0.005"}), {"--outline"}));
  EXPECT_TRUE(IsRefused(
      RunProgram({"track", (folder_ / "rec/cam0/data").string(), "-o", (folder_ / "a").string(),
                  "--camera", (folder_ / "rec/cam0/sensor.yaml").string(), "--collar",
                  (folder_ / "rec/tags0/sensor.yaml").string(), "--rate", "25", "--outline",
                  "flat"}),
      {"--diameter"}));
}

}  // namespace
}  // namespace flextip
