// flextip track on what people have: pictures, videos, live sources, runs that were interrupted.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <thread>

#include "core/rotation.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/streams/sensor_streams.h"
#include "simulation/render/laparoscope.h"
#include "tests/apps/run_program.h"
#include "tests/simulation/render_test_scene.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr int kPictures = 5;

/// Five rendered frames of a collar on its way, camera and collar beside them.
class TrackCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    simulation::Laparoscope scope(Camera(), Collar(), Options());
    for (int i = 0; i < kPictures; ++i) {
      const Image image = scope.Render(render_test::ArcShaft(Tip(i), 0.1, 0.9, 0.005), i);
      pictures_.push_back(cv::Mat(image.height_px, image.width_px, CV_8UC3,
                                  const_cast<std::uint8_t*>(image.data.data()))
                              .clone());
    }
  }
  static void TearDownTestSuite() { pictures_.clear(); }

  void SetUp() override {
    Recording recording;
    recording.instrument = {0.6, 0.005, 0.3, 0.0};
    recording.p_RP = {0.28, 0, 0};
    recording.cam0.emplace().calibration = Camera();
    recording.tags0 = Collar();
    for (int i = 0; i < kPictures; ++i) {
      recording.cam0->filenames.push_back({i * 40'000'000, fmt::format("{}.png", i)});
    }
    WriteRecording(folder_ / "rec", recording);
    fs::create_directories(folder_ / "rec/cam0/data");
    for (int i = 0; i < kPictures; ++i) Save(fmt::format("rec/cam0/data/{}.png", i), pictures_[i]);
  }

  static void WriteVideo(const std::string& file) {
    cv::VideoWriter video(file, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20,
                          pictures_[0].size());
    for (const auto& picture : pictures_) video.write(picture);
  }

  static CameraCalibration Camera() {
    CameraCalibration camera = render_test::SmallCamera();
    camera.fu_px = camera.fv_px = 420;
    camera.rate_hz = 25;
    return camera;
  }
  static TagCollar Collar() { return render_test::HexagonCollar(); }
  static Pose Tip(int i) {
    Pose T_CE;
    T_CE.R = ExpRotation({0.05, 0.3, -0.2}) * ExpRotation({-1.2, 0, 0});
    T_CE.p = {0.03 + 0.0005 * i, 0.002, 0.055};
    return T_CE;
  }
  static simulation::LaparoscopeOptions Options() {
    simulation::LaparoscopeOptions o = render_test::PlainOptions();
    o.blur_sigma_px = 0.7;
    o.exposure = 0.2;
    o.exposure_distance_m = 0.06;
    return o;
  }
  void Save(const std::string& name, const cv::Mat& picture) const {
    fs::create_directories((folder_ / name).parent_path());
    ASSERT_TRUE(cv::imwrite((folder_ / name).string(), picture));
  }
  std::vector<std::string> Arguments(const std::string& source, const std::string& out,
                                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"track",    (folder_ / source).string(),
                                          "-o",       (folder_ / out).string(),
                                          "--camera", (folder_ / "rec/cam0/sensor.yaml").string(),
                                          "--collar", (folder_ / "rec/tags0/sensor.yaml").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::string Rows(const std::string& out) const {
    return ReadText(folder_ / (out + "/vision0/data.csv"));
  }
  /// Without the times.
  std::string Tips(const std::string& out) const {
    std::istringstream lines(Rows(out));
    std::string tips;
    for (std::string line; std::getline(lines, line);) tips += line.substr(line.find(',')) + "\n";
    return tips;
  }
  std::vector<long> Times(const std::string& out) const {
    std::istringstream lines(Rows(out));
    std::vector<long> times;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) times.push_back(std::stol(line));
    return times;
  }
  nlohmann::json Summary(const std::string& out) const {
    return nlohmann::json::parse(ReadText(folder_ / (out + "/summary.json")));
  }

  static std::vector<cv::Mat> pictures_;
  TestFolder folder_;
};
std::vector<cv::Mat> TrackCommand::pictures_;

TEST_F(TrackCommand, PlainPicturesGiveTheRecordingsTips) {
  const auto recorded =
      RunProgram({"track", (folder_ / "rec").string(), "-o", (folder_ / "a").string()});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_EQ(Summary("a")["ok"], kPictures);
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "a"));
  std::istringstream last(Rows("a").substr(Rows("a").rfind('\n', Rows("a").size() - 2) + 1));
  double time = 0, x = 0;
  char comma = 0;
  last >> time >> comma >> x;
  EXPECT_NEAR(x, Tip(kPictures - 1).p.x(), 5e-4);  // the tip is where it was rendered

  const auto plain = RunProgram(Arguments("rec/cam0/data", "b", {"--rate", "25"}));
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(Rows("b"), Rows("a"));
  // Names in nanoseconds are the times; as numbers they are in another order than as texts.
  for (int i = 0; i < kPictures; ++i) {
    Save(fmt::format("ns/{}.tiff", 980'000'000 + i * 40'000'000), pictures_[i]);
  }
  const auto named = RunProgram(Arguments("ns", "c"));
  ASSERT_EQ(named.exit_code, 0) << named.err;
  EXPECT_THAT(Times("c"), testing::ElementsAre(980'000'000, 1'020'000'000, 1'060'000'000,
                                               1'100'000'000, 1'140'000'000));
  EXPECT_EQ(Tips("c"), Tips("a"));
  const auto first = RunProgram(Arguments("ns", "d", {"--rate", "10", "--frames", "2"}));
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(Times("d"), testing::ElementsAre(0, 100'000'000));
}

// The collar ends 27.5 mm before the tip; what sticks out of it bends under a known load.
TEST_F(TrackCommand, AKnownLoadBendsTheShaftBeyondTheCollar) {
  Recording recording = ReadRecording(folder_ / "rec").recording;
  recording.instrument.bending_stiffness_Nm2 = 0.02;
  const Eigen::Vector3d f_N(0.3, -0.5, 0.4);
  LoadStream& load = recording.load0.emplace();
  load.rate_hz = 25;
  load.force_noise_N = 0.05;
  for (int i = 0; i < kPictures; ++i) load.f_tip_N.push_back({i * 40'000'000, f_N});
  fs::copy(folder_ / "rec", folder_ / "loaded", fs::copy_options::recursive);
  WriteRecording(folder_ / "loaded", recording);
  std::vector<Series<TipObservation>> tips;
  for (const char* name : {"rec", "loaded"}) {
    const std::string out = std::string("out_") + name;
    const auto run =
        RunProgram({"track", (folder_ / name).string(), "-o", (folder_ / out).string()});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    fs::copy(folder_ / out / "vision0", folder_ / name / "vision0", fs::copy_options::recursive);
    tips.push_back(ReadRecording(folder_ / name).recording.vision0->tips);
  }
  for (int i = 0; i < kPictures; ++i) {
    const TipObservation &without = tips[0][i].value, &with = tips[1][i].value;
    const Eigen::Vector3d d = *without.d_RE, across_N = f_N - f_N.dot(d) * d;
    const double l = 0.0275, EI = 0.02;
    EXPECT_LT((with.p_RE - without.p_RE - l * l * l / (3 * EI) * across_N).norm(), 2e-6);
    EXPECT_LT((*with.d_RE - d - l * l / (2 * EI) * across_N).norm(), 2e-4);
    const double sd_m = l * l * l / (3 * EI) * 0.05;
    EXPECT_NEAR((with.covariance_m2 - without.covariance_m2).trace(), 2 * sd_m * sd_m,
                1e-3 * sd_m * sd_m);
  }
}

TEST_F(TrackCommand, SixteenBitsAndGreyGiveTheSameTips) {
  for (int i = 0; i < kPictures; ++i) {
    cv::Mat grey, deep, dim;
    cv::extractChannel(pictures_[i], grey, 1);
    grey.convertTo(deep, CV_16U, 257);     // 255 becomes 65535
    grey.convertTo(dim, CV_16U, 16, 200);  // a 12-bit camera's
    Save(fmt::format("grey/{}.png", i), grey);
    Save(fmt::format("deep/{}.png", i), deep);
    Save(fmt::format("dim/{}.tif", i), dim);
  }
  ASSERT_EQ(RunProgram(Arguments("grey", "a")).exit_code, 0);
  ASSERT_EQ(RunProgram(Arguments("deep", "b")).exit_code, 0);
  const auto dim = RunProgram(Arguments("dim", "c", {"--black-white", "200,4280"}));
  ASSERT_EQ(dim.exit_code, 0) << dim.err;
  EXPECT_EQ(Summary("a")["ok"], kPictures);
  EXPECT_EQ(Rows("b"), Rows("a"));
  EXPECT_EQ(Rows("c"), Rows("a"));
  EXPECT_TRUE(IsRefused(RunProgram(Arguments("dim", "d", {"--black-white", "9,9"})), {"9,9"}));
}

TEST_F(TrackCommand, ARecordedCameraOfUnknownPoseGivesTipsInItsOwnFrame) {
  std::string camera = ReadText(folder_ / "rec/cam0/sensor.yaml");
  const auto pose = camera.find("T_RC: ");
  camera.replace(pose, camera.find('\n', pose) - pose, "T_RC: unknown");
  folder_.Write("rec/cam0/sensor.yaml", camera);
  const auto out = (folder_ / "out").string();
  const auto run = RunProgram({"track", (folder_ / "rec").string(), "-o", out});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, testing::HasSubstr("in the camera's frame"));
  EXPECT_EQ(Summary("out")["verdict"]["grade"], "beware");
}

/// The four letters that name a video's codec.
std::string CodecOf(const fs::path& file) {
  const auto code = static_cast<int>(cv::VideoCapture(file.string()).get(cv::CAP_PROP_FOURCC));
  std::string letters;
  for (int i = 0; i < 4; ++i) letters += static_cast<char>((code >> 8 * i) & 0xFF);
  return letters;
}

TEST_F(TrackCommand, VideosAndLiveSourcesAreTracked) {
  const auto file = (folder_ / "v.avi").string();
  WriteVideo(file);
  const auto plain = RunProgram(Arguments("v.avi", "a", {"--overlay"}));
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(plain.err, "");
  EXPECT_EQ(Summary("a")["ok"], kPictures);
  EXPECT_THAT(Times("a"),
              testing::ElementsAre(0, 50'000'000, 100'000'000, 150'000'000, 200'000'000));
  EXPECT_THAT(CodecOf(folder_ / "a/overlay.mp4"), testing::AnyOf("avc1", "h264", "vp09"));
  EXPECT_THAT(ReadText(folder_ / "a/report.html"), HasSubstr("<video controls"));

  // A file given as live waits for its reader: the same tables, with the same times.
  auto arguments = Arguments("v.avi", "b");
  arguments.insert(arguments.begin() + 1, "--live");
  const auto live_file = RunProgram(arguments);
  ASSERT_EQ(live_file.exit_code, 0) << live_file.err;
  EXPECT_EQ(Rows("b"), Rows("a"));
}

TEST_F(TrackCommand, ALiveSourceIsStampedByTheClock) {
  const auto file = (folder_ / "v.avi").string(), pipe = (folder_ / "pipe").string();
  WriteVideo(file);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::thread camera([&] {
    std::ofstream(pipe, std::ios::binary) << std::ifstream(file, std::ios::binary).rdbuf();
  });
  auto arguments = Arguments("pipe", "b");
  arguments.insert(arguments.begin() + 1, "--live");
  const auto now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                       std::chrono::system_clock::now().time_since_epoch())
                       .count();
  (void)RunProgram(arguments);  // five frames at once: too fast for the search beside them
  camera.join();
  ASSERT_EQ(Times("b").size(), static_cast<std::size_t>(kPictures));
  EXPECT_GE(Times("b")[0], now);
  EXPECT_LT(Times("b")[2], now + 60'000'000'000);
  EXPECT_LT(Times("b")[0], Times("b")[1]);
}

TEST_F(TrackCommand, RefusesWhatItCannotTrack) {
  const auto out = (folder_ / "out").string();
  const auto rec = (folder_ / "rec").string();
  EXPECT_TRUE(IsRefused(RunProgram({"track", "-o", out}), {"--live"}));
  EXPECT_TRUE(IsRefused(RunProgram(Arguments("none", "out")), {"none"}));
  EXPECT_TRUE(IsRefused(RunProgram(Arguments("rec", "out")), {"rec", "--camera"}));
  EXPECT_TRUE(IsRefused(RunProgram({"track", rec + "/cam0/sensor.yaml", "-o", out}),
                        {"--camera FILE and --collar FILE"}));
  EXPECT_TRUE(IsRefused(RunProgram(Arguments("rec/cam0/sensor.yaml", "out")), {"video"}));
  fs::create_directory(folder_ / "empty");
  EXPECT_TRUE(IsRefused(RunProgram(Arguments("empty", "out")), {"empty", "PNG"}));
  Save("small/0.png", cv::Mat(10, 20, CV_8UC1, cv::Scalar(9)));
  EXPECT_TRUE(IsRefused(RunProgram(Arguments("small", "out")), {"0.png", "20 x 10", "320 x 240"}));
  auto live = Arguments("no-such-stream", "out");
  live.insert(live.begin() + 1, "--live");
  EXPECT_TRUE(IsRefused(RunProgram(live), {"live source"}));
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(TrackCommand, AKilledRunIsResumedToTheSameTables) {
  constexpr int kFrames = 150;
  fs::create_directory(folder_ / "many");
  for (int i = 0; i < kFrames; ++i) {  // to and fro
    const int at = i % (2 * kPictures - 2), picture = at < kPictures ? at : 2 * kPictures - 2 - at;
    fs::create_hard_link(folder_ / fmt::format("rec/cam0/data/{}.png", picture),
                         folder_ / fmt::format("many/{}.png", i));
  }
  const auto whole = RunProgram(Arguments("many", "whole"));
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  KillAtFileSize(Arguments("many", "out", {"--quiet"}),
                 fs::file_size(folder_ / "whole/tags0/data.csv") * 3 / 4);
  ASSERT_FALSE(fs::exists(folder_ / "out"));
  const auto resumed = RunProgram(Arguments("many", "out", {"--resume"}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(Rows("out"), Rows("whole"));
  EXPECT_EQ(ReadText(folder_ / "out/tags0/data.csv"), ReadText(folder_ / "whole/tags0/data.csv"));
  EXPECT_EQ(ReadText(folder_ / "out/vision0/sensor.yaml"),
            ReadText(folder_ / "whole/vision0/sensor.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "out/unfinished.json"));
  for (const char* key : {"frames", "ok", "predicted", "lost", "tags_per_frame"}) {
    EXPECT_EQ(Summary("out")[key], Summary("whole")[key]) << key;
  }
  EXPECT_THAT(Summary("out")["warnings"].dump(), HasSubstr("resumed"));
  EXPECT_THAT(Summary("whole")["warnings"], testing::IsEmpty());
  for (const auto& entry : fs::directory_iterator(folder_ / "")) {
    EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr("partial")));
  }
}

}  // namespace
}  // namespace flextip
