// Numbers that are finite and absurd, and pipes in the place of files: commands refuse them at
// once, by one line with file, key, value and bound.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <regex>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

const std::string kData = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/";

class Absurd : public testing::Test {
 protected:
  /// Copies the data, and puts `by` in the place of the first match of `pattern` in one of its
  /// files.
  std::string Changed(const std::string& source, const std::string& file,
                      const std::string& pattern, const std::string& by) const {
    const fs::path copy = folder_ / fs::path(source).filename().string();
    fs::remove_all(copy);
    fs::copy(kData + source, copy, fs::copy_options::recursive);
    const fs::path changed = file.empty() ? copy : copy / file;
    const std::string before = ReadText(changed);
    const std::string after = std::regex_replace(before, std::regex(pattern), by,
                                                 std::regex_constants::format_first_only);
    EXPECT_NE(after, before) << pattern;
    folder_.Write(fs::relative(changed, folder_ / "").string(), after);
    return copy.string();
  }
  testing::AssertionResult Refuses(const std::vector<std::string>& command,
                                   const std::vector<std::string>& parts) const {
    std::vector<std::string> line = command;
    line.insert(line.end(), {"-o", (folder_ / "out").string()});
    const auto result = RunProgram(line);
    if (fs::exists(folder_ / "out")) {
      fs::remove_all(folder_ / "out");
      return testing::AssertionFailure() << "left a result";
    }
    return IsRefused(result, parts);
  }

  TestFolder folder_;
};

TEST_F(Absurd, DiagnoseRefusesNoisesGravityAndColumns) {
  const std::string sample = "recordings/sample_0";
  struct Case {
    const char *file, *pattern, *by;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases{{"em0/sensor.yaml",
                                 "(position_noise_m:) \\S+",
                                 "$1 1e150",
                                 {"em0/sensor.yaml:", "position_noise_m", "1e150", " m"}},
                                {"recording.yaml",
                                 "(gravity_m_s2:) \\[[^\\]]*\\]",
                                 "$1 [0, 0, -1e150]",
                                 {"recording.yaml:", "gravity_m_s2", "1e150", "m/s2"}},
                                {"em0/sensor.yaml",
                                 "(noise_distribution: gaussian)",
                                 "$1\nregistration_noise_rad: 1e150",
                                 {"em0/sensor.yaml:", "registration_noise_rad", "1e150", "rad"}},
                                {"strain0/data.csv",
                                 "\n(\\d+),[^,]+",
                                 "\n$1,1e150",
                                 {"strain0/data.csv:2:", "m1_y [Nm]", "1e150", "N m"}}};
  for (const Case& c : cases) {
    EXPECT_TRUE(Refuses({"diagnose", Changed(sample, c.file, c.pattern, c.by)}, c.parts))
        << c.file << " " << c.pattern;
  }
}

TEST_F(Absurd, SimulateRefusesWhatWouldNotEnd) {
  const std::string scenario = "scenarios/direction.yaml";
  EXPECT_TRUE(Refuses({"simulate", Changed(scenario, "", "(rate_hz:) [0-9.]+", "$1 1e9")},
                      {"direction.yaml:", "rate_hz", "1e9", "Hz"}));
  EXPECT_TRUE(Refuses({"simulate", Changed(scenario, "", "(\n  speed_m_s:) [0-9.]+", "$1 1e-9")},
                      {"direction.yaml:", "speed_m_s", "1e-9", "m/s"}));
  EXPECT_TRUE(Refuses({"simulate", Changed(scenario, "", "(\n  speed_m_s:) [0-9.]+", "$1 1e-6")},
                      {"direction.yaml:", "speed_m_s", "takes", "4500 s"}));
  // 500 s at 1e4 Hz, twice: each within its bounds.
  EXPECT_TRUE(Refuses(
      {"simulate", Changed(scenario, "", "(wrist: \\{rate_hz:) 30([^$]*\n  speed_m_s:) [0-9.]+",
                           "$1 1e4$2 1e-5")},
      {"direction.yaml:", "1e+07 samples", "at most 5e+06"}));
}

TEST_F(Absurd, MapRefusesWhatNoMemoryHolds) {
  const std::string map = "maps/thesis.yaml";
  EXPECT_TRUE(Refuses({"map", Changed(map, "", "(position_m:) \\[[^\\]]*\\]", "$1 [0, 1e150, 0]")},
                      {"thesis.yaml:", "position_m", "1e150"}));
  EXPECT_TRUE(Refuses({"map", Changed(map, "", "(length_m:) [0-9.]+", "$1 1e-9")},
                      {"thesis.yaml:", "length_m", "1e-9"}));
}

TEST_F(Absurd, CornersOfAPictureThatNoMemoryHolds) {
  const auto file = folder_.Write("corners.csv",
                                  "#flextip-corners 1\n#board chessboard:9x6:0.025\n"
                                  "#resolution 100000 100000\n#image,id [],x [px],y [px]\n"
                                  "a,0,1,1\n");
  EXPECT_TRUE(Refuses({"calibrate", "camera", "--corners", file, "--board", "chessboard:9x6:0.025"},
                      {"corners.csv:3:", "pixels"}));
}

TEST_F(Absurd, APipeIsRefusedByEveryCommand) {
  const std::string pipe = (folder_ / "pipe").string(), sample = kData + "recordings/sample_0";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::vector<std::vector<std::string>> commands{
      {"simulate", pipe},
      {"simulate", kData + "scenarios/press.yaml", "--model", pipe},
      {"map", pipe},
      {"estimate", sample, "--calibration", pipe},
      {"estimate", sample, "--model", pipe},
      {"calibrate", "camera", "--corners", pipe, "--board", "chessboard:9x6:0.025"},
      {"collar", "--camera", pipe},
      {"import", "csv", pipe},
      {"import", "rosbag", pipe},
      {"import", "csv", sample + "/wrist0/data.csv", "--map", pipe},
      {"shape", "--batch", pipe},
      {"batch", "check", pipe}};
  for (const auto& command : commands) {
    const auto result = Refuses(command, {pipe});
    EXPECT_TRUE(result) << command[0] << " " << command[1] << ": " << result.message();
  }
  EXPECT_TRUE(IsRefused(RunProgram({"convert", "camera", pipe, (folder_ / "sensor.yaml").string()}),
                        {pipe}));
  EXPECT_TRUE(IsRefused(RunProgram({"detect", pipe}), {pipe}));
}

TEST_F(Absurd, ControlCharactersReachNoTerminal) {
  const auto file = folder_.Write("a\x1b[31m.yaml", "arm: {kind: \"x\\e[2J\\a\"}\n");
  const auto result = RunProgram({"map", file, "-o", (folder_ / "out").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
  EXPECT_EQ(result.err.find('\a'), std::string::npos);
}

}  // namespace
}  // namespace flextip
