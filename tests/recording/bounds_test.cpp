// Numbers that are finite and absurd are refused where they are read, with file, line, key, value
// and bound; what a wrong unit makes of a real value is not, since the check names the unit.
#include "recording/text/bounds.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "recording/calibrations/file.h"
#include "recording/cameras/camera_file.h"
#include "recording/cameras/camera_formats.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/csv.h"
#include "recording/text/yaml_map.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::Line;
using flextip::test_support::Refusal;
using flextip::test_support::Replace;
using flextip::test_support::ReplaceLine;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteSample;
using flextip::test_support::WriteText;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Bounds, AreFoundByTheUnitInTheName) {
  EXPECT_STREQ(BoundsOf("length_m").unit, "m");
  EXPECT_EQ(BoundsOf("instrument.length_m").most, 1e4);
  EXPECT_EQ(BoundsOf("position_m").most, 1e5);
  EXPECT_STREQ(BoundsOf("gravity_m_s2").unit, "m/s2");
  EXPECT_STREQ(BoundsOf("mass_per_length_kg_m").unit, "kg/m");
  EXPECT_STREQ(BoundsOf("compliance_m_N").unit, "m/N");
  EXPECT_STREQ(BoundsOf("stiffness_N_m").unit, "N/m");
  EXPECT_STREQ(BoundsOf("control.tip_latency_s.value").unit, "s");
  EXPECT_STREQ(BoundsOf("T_RC.data").unit, "m");
  EXPECT_STREQ(BoundsOf("found.tip.p_WE").unit, "m");
  EXPECT_STREQ(BoundsOf("found.cam0.intrinsics").unit, "px");
  EXPECT_STREQ(BoundsOf("p_RW_x [m]").unit, "m");
  EXPECT_STREQ(BoundsOf("m1_y [Nm]").unit, "N m");
  EXPECT_STREQ(BoundsOf("cov_xx [m2]").unit, "m2");
  EXPECT_STREQ(BoundsOf("F_p_over_EI [1/m2]").unit, "1/m2");
  EXPECT_STREQ(BoundsOf("q_RW_w []").unit, "");
  EXPECT_FALSE(KnownBoundsOf("seed"));
  EXPECT_FALSE(KnownBoundsOf("rm"));
}

TEST(Bounds, OfWhatMustBePositiveHaveALeast) {
  const Bounds rate = BoundsOf("rate_hz");
  EXPECT_EQ(ExpectedAbove(rate, 30.0, false), "");
  EXPECT_THAT(ExpectedAbove(rate, 1e9, false), HasSubstr("100000 Hz"));
  EXPECT_THAT(ExpectedAbove(rate, 1e-9, false), HasSubstr("0.0001"));
  EXPECT_EQ(ExpectedAbove(BoundsOf("position_noise_m"), 0.0, true), "");
  EXPECT_NE(ExpectedAbove(BoundsOf("position_noise_m"), 1e-200, true), "");
  EXPECT_EQ(ExpectedWithin(BoundsOf("position_m"), 5e-324), "");
}

struct AbsurdCase {
  const char* file;
  const char* key;
  const char* value;
};
void PrintTo(const AbsurdCase& c, std::ostream* out) { *out << c.file << " " << c.key; }

class RefusesAbsurd : public ::testing::TestWithParam<AbsurdCase> {};

TEST_P(RefusesAbsurd, WithFileLineKeyValueAndBound) {
  const AbsurdCase& c = GetParam();
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const auto file = folder / c.file;
  int line = 1;
  std::string text = Line(file, line);
  const std::string key = std::string(c.key) + ": ";
  while (text.find(key) == std::string::npos) text = Line(file, ++line);
  const std::string head = text.substr(0, text.find(key) + key.size());
  ReplaceLine(file, line, head + c.value);
  const std::string message = Refusal([&] { ReadRecording(folder.path()); });
  EXPECT_THAT(message, AllOf(HasSubstr(fmt::format("{}:{}: ", c.file, line)), HasSubstr(c.key),
                             HasSubstr("1e"), HasSubstr("expected"), HasSubstr(" to ")));
}

INSTANTIATE_TEST_SUITE_P(
    Keys, RefusesAbsurd,
    ::testing::Values(AbsurdCase{"recording.yaml", "length_m", "1e150"},
                      AbsurdCase{"recording.yaml", "length_m", "1e-150"},
                      AbsurdCase{"recording.yaml", "outer_diameter_m", "1e150"},
                      AbsurdCase{"recording.yaml", "bending_stiffness_Nm2", "1e150"},
                      AbsurdCase{"recording.yaml", "bending_stiffness_Nm2", "1e-150"},
                      AbsurdCase{"recording.yaml", "mass_per_length_kg_m", "1e150"},
                      AbsurdCase{"recording.yaml", "gravity_m_s2", "[0, 0, -1e150]"},
                      AbsurdCase{"recording.yaml", "position_m", "[0, 1e150, 0]"},
                      AbsurdCase{"recording.yaml", "port_offset.offset_m", "[1e150, 1, 1]"},
                      AbsurdCase{"wrist0/sensor.yaml", "rate_hz", "1e150"},
                      AbsurdCase{"wrist0/sensor.yaml", "position_noise_m", "1e150"},
                      AbsurdCase{"wrist0/sensor.yaml", "position_noise_m", "1e-150"},
                      AbsurdCase{"wrist0/sensor.yaml", "orientation_noise_rad", "1e150"},
                      AbsurdCase{"em0/sensor.yaml", "registration_noise_m", "1e150"},
                      AbsurdCase{"em0/sensor.yaml", "registration_noise_rad", "1e150"},
                      AbsurdCase{"strain0/sensor.yaml", "moment_noise_Nm", "1e150"},
                      AbsurdCase{"load0/sensor.yaml", "force_noise_N", "1e150"},
                      AbsurdCase{"vision0/sensor.yaml", "direction_noise_rad", "1e150"},
                      AbsurdCase{"cam0/sensor.yaml", "intrinsics", "[1e150, 32, 15, 11]"},
                      AbsurdCase{"cam0/sensor.yaml", "distortion_coefficients", "[1e150, 0, 0, 0]"},
                      AbsurdCase{"cam0/sensor.yaml", "gamma", "1e150"}));

TEST(Bounds, RefuseACellOfATableWithItsColumn) {
  for (const char* file : {"wrist0/data.csv", "em0/data.csv", "strain0/data.csv", "load0/data.csv",
                           "command0/data.csv", "vision0/data.csv"}) {
    const TemporaryFolder folder;
    WriteSample(folder.path());
    std::string line = Line(folder / file, 3);
    const auto first = line.find(','), second = line.find(',', first + 1);
    line.replace(first + 1, second - first - 1, "1e150");
    ReplaceLine(folder / file, 3, line);
    EXPECT_THAT(Refusal([&] { ReadRecording(folder.path()); }),
                AllOf(HasSubstr(fmt::format("{}:3: found \"1e150\" in column ", file)),
                      HasSubstr("expected -")));
  }
}

TEST(Bounds, RefuseATimeThatLeaps) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const std::string line = Line(folder / "load0/data.csv", 7);
  ReplaceLine(folder / "load0/data.csv", 7, "1900000000000000000" + line.substr(line.find(',')));
  EXPECT_THAT(Refusal([&] { ReadRecording(folder.path()); }),
              AllOf(HasSubstr("load0/data.csv:7: "), HasSubstr("leaps"), HasSubstr("30 days")));
  ReplaceLine(folder / "load0/data.csv", 2, "-9223372036854775808" + line.substr(line.find(',')));
  EXPECT_THAT(Refusal([&] { ReadRecording(folder.path()); }),
              AllOf(HasSubstr("load0/data.csv:2: "), HasSubstr("timestamp [ns]")));
}

TEST(Bounds, LeaveWrongUnitsToTheCheck) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  Replace(folder / "recording.yaml", "length_m: 0.6", "length_m: 600");
  Replace(folder / "recording.yaml", "gravity_m_s2: [0, -0, -9.80665]",
          "gravity_m_s2: [0, 0, -9806.65]");
  EXPECT_EQ(ReadRecording(folder.path()).recording.instrument.length_m, 600.0);
}

TEST(Bounds, RefuseAPictureThatNoMemoryHolds) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  Replace(folder / "cam0/sensor.yaml", "resolution: [32, 24]", "resolution: [100000, 100000]");
  EXPECT_THAT(Refusal([&] { ReadRecording(folder.path()); }),
              AllOf(HasSubstr("cam0/sensor.yaml:"), HasSubstr("pixels")));
}

TEST(Bounds, HoldForForeignCameras) {
  const TemporaryFolder folder;
  const auto refusal = [&](const char* text, CameraFormat format) {
    WriteText(folder / "camera.yaml", text);
    return Refusal([&] { ReadCameraDescription(folder / "camera.yaml", format); });
  };
  EXPECT_THAT(refusal("image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
                      "  data: [1e150, 0, 320, 0, 500, 240, 0, 0, 1]\n",
                      CameraFormat::kRos),
              AllOf(HasSubstr("camera.yaml:6: "), HasSubstr("1e150"), HasSubstr("px")));
  EXPECT_THAT(refusal("image_width: 4294967936\nimage_height: 480\n", CameraFormat::kRos),
              AllOf(HasSubstr("camera.yaml:1: image_width"), HasSubstr("100000 px")));
  EXPECT_THAT(
      refusal("%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
              "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
              "   data: [ 1e150, 0., 320., 0., 500., 240., 0., 0., 1. ]\n",
              CameraFormat::kOpenCv),
      AllOf(HasSubstr("camera.yaml:9: camera_matrix.data: found \"1e150\""), HasSubstr("px")));
}

TEST(Bounds, HoldForCalibrations) {
  const TemporaryFolder folder;
  WriteText(folder / "calibration.yaml",
            "format: flextip-calibration\nversion: 1\nkind: tip\nfound:\n"
            "  tip.p_WE: [1e150, 0, 0]\n");
  EXPECT_THAT(Refusal([&] { ReadCalibration(folder / "calibration.yaml"); }),
              AllOf(HasSubstr("calibration.yaml:5: found.tip.p_WE"), HasSubstr("1e150")));
}

TEST(Bounds, AreKeptByTheWriterToo) {
  CsvWriter csv({"p_RW_x [m]"});
  csv.KeepBounds();
  EXPECT_THROW(csv.Add(1e150), WorkError);
  Recording recording;
  recording.load0 = LoadStream{"cell", 50.0, 0.005, {{0, {0.0, 1e150, 0.0}}}};
  const TemporaryFolder folder;
  EXPECT_THROW(WriteRecording(folder.path(), recording), WorkError);
}

}  // namespace
}  // namespace flextip
