// Input that commands cannot use: one clear line, exit code 2, and no folder that looks like a
// result.
#include <gmock/gmock.h>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

const char* kRecordingYaml =
    "format: flextip-recording\nversion: 1\n"
    "instrument: {length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304, "
    "mass_per_length_kg_m: 0.0}\n"
    "port: {position_m: [0.28, 0.0, 0.0]}\ngravity_m_s2: [0.0, 0.0, -9.81]\n";

const char* kWristYaml =
    "sensor_type: wrist\nrate_hz: 50\ncomment: test\n"
    "position_noise_m: 0.0001\norientation_noise_rad: 0.001\n";
const char* kWristHeader =
    "#timestamp [ns],p_RW_x [m],p_RW_y [m],p_RW_z [m],q_RW_w [],q_RW_x [],q_RW_y [],q_RW_z []\n";

const char* kCameraYaml =
    "sensor_type: camera\nrate_hz: 30\ncomment: test\ncamera_model: pinhole\n"
    "intrinsics: [500, 500, 320, 240]\ndistortion_model: radial-tangential\n"
    "distortion_coefficients: {}\nresolution: [640, 480]\n"
    "T_RC: {rows: 4, cols: 4, data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}\n";
const char* kTagsYaml =
    "sensor_type: tags\ncomment: test\nfamily: tag36h11\ntags:\n"
    "  - {id: 0, size_m: 0.004, T_EG: {rows: 4, cols: 4, data: [1,0,0,0, 0,1,0,0, 0,0,1,0, "
    "0,0,0,1]}}\n";

std::string CameraYaml(const std::string& coefficients) {
  std::string text = kCameraYaml;
  return text.replace(text.find("{}"), 2, coefficients);
}

class BadInput : public testing::Test {
 protected:
  void SetUp() override { folder_.Write("rec/recording.yaml", kRecordingYaml); }

  void WriteWrist(const std::string& rows) const {
    folder_.Write("rec/wrist0/sensor.yaml", kWristYaml);
    folder_.Write("rec/wrist0/data.csv", kWristHeader + rows);
  }
  void WriteCamera(const std::string& coefficients, const std::string& frame) const {
    folder_.Write("rec/cam0/sensor.yaml", CameraYaml(coefficients));
    folder_.Write("rec/cam0/data.csv", "#timestamp [ns],filename\n0,0.png\n");
    folder_.Write("rec/cam0/data/0.png", frame);
    folder_.Write("rec/tags0/sensor.yaml", kTagsYaml);
  }
  testing::AssertionResult Refuses(const std::string& command,
                                   const std::vector<std::string>& parts) const {
    const auto result =
        RunProgram({command, (folder_ / "rec").string(), "-o", (folder_ / "out").string()});
    if (std::filesystem::exists(folder_ / "out")) {
      return testing::AssertionFailure() << "left a folder behind";
    }
    return IsRefused(result, parts);
  }

  TestFolder folder_;
};

TEST_F(BadInput, MissingFolder) {
  for (const std::string command : {"track", "estimate"}) {
    const auto none = (folder_ / "none").string();
    EXPECT_TRUE(IsRefused(RunProgram({command, none, "-o", (folder_ / "out").string()}), {"none"}));
  }
}

TEST_F(BadInput, WrongColumns) {
  WriteWrist("");
  folder_.Write("rec/wrist0/data.csv", "#timestamp [ns],p_RW_x [m],p_RW_y [m]\n");
  EXPECT_TRUE(Refuses("estimate", {"wrist0/data.csv:1:", "p_RW_z"}));
}

TEST_F(BadInput, TruncatedLine) {
  WriteWrist("0,0,0,0,1,0,0,0\n20000000,0,0\n40000000,0,0,0,1,0,0,0\n");
  EXPECT_TRUE(Refuses("estimate", {"wrist0/data.csv:3:"}));
}

TEST_F(BadInput, NotANumber) {
  WriteWrist("0,0,0,0,1,0,0,0\n20000000,0,nan,0,1,0,0,0\n40000000,0,0,0,1,0,0,0\n");
  EXPECT_TRUE(Refuses("estimate", {"wrist0/data.csv:3:", "nan"}));
}

TEST_F(BadInput, TimeRunningBackwards) {
  WriteWrist("20000000,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n40000000,0,0,0,1,0,0,0\n");
  EXPECT_TRUE(Refuses("estimate", {"wrist0/data.csv:3:"}));
}

TEST_F(BadInput, QuaternionOffUnitLength) {
  WriteWrist("0,0,0,0,1,0,0,0\n20000000,0,0,0,1.1,0,0,0\n40000000,0,0,0,1,0,0,0\n");
  EXPECT_TRUE(Refuses("estimate", {"wrist0/data.csv:3:"}));
}

TEST_F(BadInput, UnknownVersion) {
  std::string text = kRecordingYaml;
  folder_.Write("rec/recording.yaml", text.replace(text.find("version: 1"), 10, "version: 7"));
  EXPECT_TRUE(Refuses("estimate", {"recording.yaml", "7"}));
}

TEST_F(BadInput, CameraWithAWrongNumberOfCoefficients) {
  WriteCamera("[0.1, 0.2, 0.3]", "");
  EXPECT_TRUE(Refuses("track", {"cam0/sensor.yaml", "3", "4"}));
}

TEST_F(BadInput, EmptyFrame) {
  WriteCamera("[0, 0, 0, 0]", "");
  EXPECT_TRUE(Refuses("track", {"0.png"}));
}

TEST_F(BadInput, FrameOfNonsense) {
  WriteCamera("[0, 0, 0, 0]", std::string(5000, 'x'));
  EXPECT_TRUE(Refuses("track", {"0.png"}));
}

TEST_F(BadInput, NoFramesToTrack) {
  WriteWrist("0,0,0,0,1,0,0,0\n");
  EXPECT_TRUE(Refuses("track", {"rec", "cam0"}));
}

TEST_F(BadInput, ImagesThatAreNone) {
  const auto empty = folder_.Write("empty.png", ""),
             nonsense = folder_.Write("x.jpg", "no picture");
  const auto none = (folder_ / "none.png").string(), out = (folder_ / "out").string();
  for (const auto& file : {empty, nonsense, none}) {
    EXPECT_TRUE(IsRefused(RunProgram({"detect", file}), {file}));
    EXPECT_TRUE(IsRefused(
        RunProgram({"calibrate", "camera", file, "--board", "chessboard:9x6:0.025", "-o", out}),
        {file}));
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(BadInput, BoardThatIsNone) {
  const auto file = folder_.Write("empty.png", ""), out = (folder_ / "out").string();
  for (const std::string board :
       {"", "chessboard", "chessboard:9x:0.025", "chessboard:9x6:-1", "chess:9x6:1"}) {
    EXPECT_TRUE(
        IsRefused(RunProgram({"calibrate", "camera", file, "--board", board, "-o", out}), {board}))
        << board;
  }
}

TEST_F(BadInput, FolderThatHoldsSomethingElse) {
  WriteWrist("0,0,0,0,1,0,0,0\n");
  const auto kept = folder_.Write("out/precious.txt", "kept");
  const auto result =
      RunProgram({"estimate", (folder_ / "rec").string(), "-o", (folder_ / "out").string()});
  EXPECT_TRUE(IsRefused(result, {"--force"}));
  EXPECT_EQ(ReadText(kept), "kept");
}

}  // namespace
}  // namespace flextip
