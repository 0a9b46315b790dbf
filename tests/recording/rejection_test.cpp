// One line of a good recording is spoilt at a time; the message must name the file and the line.
#include <gmock/gmock.h>

#include "core/error.h"
#include "recording/recording_reader.h"
#include "recording/truth.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::Line;
using flextip::test_support::Replace;
using flextip::test_support::ReplaceLine;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteSample;
using ::testing::HasSubstr;
using ::testing::Not;

std::string Failure(const std::filesystem::path& folder) {
  try {
    ReadRecording(folder);
    ReadTruth(folder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without an error";
}

/// A field of a line of data.csv gets another text.
struct FieldCase {
  const char* file;
  int line;
  int field;  ///< from 0
  const char* text;
  const char* message;
};
void PrintTo(const FieldCase& c, std::ostream* out) {
  *out << c.file << ":" << c.line << " field " << c.field << " " << c.text;
}

std::string WithField(const std::string& line, int field, const std::string& text) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  fields.at(static_cast<std::size_t>(field)) = text;
  std::string joined = fields[0];
  for (std::size_t i = 1; i < fields.size(); ++i) joined += "," + fields[i];
  return joined;
}

class RejectsField : public ::testing::TestWithParam<FieldCase> {};

TEST_P(RejectsField, WithFileAndLine) {
  const auto& c = GetParam();
  const TemporaryFolder folder;
  WriteSample(folder.path());
  ASSERT_EQ(Failure(folder.path()), "read without an error");
  const auto file = folder / c.file;
  ReplaceLine(file, c.line, WithField(Line(file, c.line), c.field, c.text));
  const std::string message = Failure(folder.path());
  EXPECT_THAT(message, HasSubstr(fmt::format("{}:{}: ", c.file, c.line)));
  EXPECT_THAT(message, HasSubstr(c.message));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

constexpr const char* kEarlier = "1600000000000000000";
constexpr const char* kFinite = "expected a finite number";

INSTANTIATE_TEST_SUITE_P(
    Values, RejectsField,
    ::testing::Values(
        FieldCase{"wrist0/data.csv", 3, 1, "nan", kFinite},
        FieldCase{"wrist0/data.csv", 4, 3, "-inf", kFinite},
        FieldCase{"wrist0/data.csv", 4, 3, "", kFinite},
        FieldCase{"wrist0/data.csv", 4, 6, "nan", kFinite},
        FieldCase{"wrist0/data.csv", 4, 6, "", "expected all or none of them"},
        FieldCase{"wrist0/data.csv", 4, 4, "1.9", "quaternion has length"},
        FieldCase{"command0/data.csv", 2, 2, "inf", kFinite},
        FieldCase{"em0/data.csv", 7, 3, "NaN", kFinite},
        FieldCase{"em0/data.csv", 3, 7, "7", "quaternion has length"},
        FieldCase{"em0/data.csv", 3, 7, "", kFinite},
        FieldCase{"em1/data.csv", 2, 5, "-9", "quaternion has length"},
        FieldCase{"strain0/data.csv", 5, 4, "nan", kFinite},
        FieldCase{"load0/data.csv", 5, 3, "1e999", kFinite},
        FieldCase{"vision0/data.csv", 2, 1, "nan", kFinite},
        FieldCase{"vision0/data.csv", 2, 1, "", kFinite},
        FieldCase{"vision0/data.csv", 2, 4, "-1e-6", "the covariance has the eigenvalue"},
        FieldCase{"vision0/data.csv", 2, 9, "inf", kFinite},
        FieldCase{"vision0/data.csv", 2, 11, "", "expected all or none of them"},
        FieldCase{"vision0/data.csv", 2, 11, "5", "direction has length"},
        FieldCase{"vision0/data.csv", 2, 13, "fine", "expected ok, predicted or lost"},
        FieldCase{"vision0/data.csv", 4, 2, "nan", kFinite},
        FieldCase{"truth0/data.csv", 4, 2, "nan", kFinite},
        FieldCase{"truth0/data.csv", 4, 5, "3", "quaternion has length"},
        FieldCase{"cam0/data.csv", 4, 1, "none.png", "is missing"},
        FieldCase{"cam1/data.csv", 4, 1, "none.png", "is missing"},
        FieldCase{"cam0/data.csv", 4, 1, "../data/2.png", "expected the name of a file"}));

INSTANTIATE_TEST_SUITE_P(
    Times, RejectsField,
    ::testing::Values(FieldCase{"wrist0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"command0/data.csv", 7, 0, kEarlier, "runs backwards"},
                      FieldCase{"em0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"em1/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"strain0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"load0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"cam0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"vision0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"truth0/data.csv", 3, 0, kEarlier, "runs backwards"},
                      FieldCase{"em0/data.csv", 3, 0, "1700000000000000000", "stands still"},
                      FieldCase{"em0/data.csv", 3, 0, "1.7e18", "expected an integer"},
                      FieldCase{"em0/data.csv", 3, 0, "", "expected an integer"}));

class RejectsColumns : public ::testing::TestWithParam<const char*> {};

TEST_P(RejectsColumns, MissingExtraAndRenamed) {
  const std::string name = std::string(GetParam()) + "/data.csv";
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const auto file = folder / name;
  const std::string header = Line(file, 1);
  const std::string row = Line(file, 5);

  ReplaceLine(file, 1, header + ",more []");
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ":1: extra column \"more []\""));
  ReplaceLine(file, 1, header.substr(0, header.rfind(',')));
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ":1: column \""));
  EXPECT_THAT(Failure(folder.path()), HasSubstr("\" is missing"));
  ReplaceLine(file, 1, header.substr(1));
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ":1: found \"timestamp [ns]"));
  ReplaceLine(file, 1, header);

  ReplaceLine(file, 5, row + ",0");
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ":5: found "));
  ReplaceLine(file, 5, row.substr(0, row.rfind(',')));
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ":5: found "));
  ReplaceLine(file, 5, row);

  flextip::test_support::WriteText(file, header + "\n");
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ":1: no samples"));
  std::filesystem::remove(file);
  EXPECT_THAT(Failure(folder.path()), HasSubstr(name + ": no such file"));
}

INSTANTIATE_TEST_SUITE_P(Streams, RejectsColumns,
                         ::testing::Values("wrist0", "command0", "em0", "em1", "strain0", "load0",
                                           "cam0", "vision0", "truth0"));

/// A text in a YAML file is replaced. The error is expected at the text's line, or at `line` (a
/// missing key is reported where its mapping begins).
struct YamlCase {
  const char* file;
  const char* from;
  const char* to;
  const char* message;
  int line = 0;  ///< 0: where `from` was
};
void PrintTo(const YamlCase& c, std::ostream* out) {
  *out << c.file << ": " << c.from << " -> " << c.to;
}

class RejectsYaml : public ::testing::TestWithParam<YamlCase> {};

TEST_P(RejectsYaml, WithFileAndLine) {
  const auto& c = GetParam();
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const int found = Replace(folder / c.file, c.from, c.to);
  const std::string message = Failure(folder.path());
  EXPECT_THAT(message, HasSubstr(fmt::format("{}:{}: ", c.file, c.line > 0 ? c.line : found)));
  EXPECT_THAT(message, HasSubstr(c.message));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    RecordingYaml, RejectsYaml,
    ::testing::Values(
        YamlCase{"recording.yaml", "version: 1", "version: 2", "unknown version 2, expected 1"},
        YamlCase{"recording.yaml", "version: 1", "version: one", "expected an integer"},
        YamlCase{"recording.yaml", "version: 1\n", "", "key \"version\" is missing", 1},
        YamlCase{"recording.yaml", "flextip-recording", "rosbag", "expected flextip-recording"},
        YamlCase{"recording.yaml", "length_m: 0.6", "length_m: 0", "expected a number above 0"},
        YamlCase{"recording.yaml", "length_m: 0.6", "length_m: -0.6", "expected a number above 0"},
        YamlCase{"recording.yaml", "length_m: 0.6", "length_m: .nan", "expected a finite number"},
        YamlCase{"recording.yaml", "length_m: 0.6", "length_m: 0.6 m", "expected a finite number"},
        YamlCase{"recording.yaml", "length_m: 0.6\n", "x: 1\n", "\"instrument.length_m\" is missi"},
        YamlCase{"recording.yaml", "outer_diameter_m: 0", "outer_diameter_m: -0", "above 0"},
        YamlCase{"recording.yaml", "bending_stiffness_Nm2: 0", "bending_stiffness_Nm2: -0",
                 "above"},
        YamlCase{"recording.yaml", "mass_per_length_kg_m: 0", "mass_per_length_kg_m: -0",
                 "below 0"},
        YamlCase{"recording.yaml", "gravity_m_s2: [0", "gravity_m_s2: [0, 0", "expected 3 numbers"},
        YamlCase{"recording.yaml", "gravity_m_s2: [0", "gravity_m_s2: [.inf", "a finite number in"},
        YamlCase{"recording.yaml", "port:", "prt:", "key \"port\" is missing", 1},
        YamlCase{"recording.yaml", "  stiffness.scale: 0", "  stiffness.scale: -0", "above 0"},
        YamlCase{"recording.yaml", "  stiffness.scale", "  stiffness", "effect.parameter"},
        YamlCase{"recording.yaml", "version: 1", "format: 1", "\"format\" is there twice"},
        YamlCase{"recording.yaml", "version: 1", "version: [1", "not YAML", 3}));

INSTANTIATE_TEST_SUITE_P(
    SensorYaml, RejectsYaml,
    ::testing::Values(
        YamlCase{"wrist0/sensor.yaml", "rate_hz: 50", "rate_hz: 0", "expected a number above 0"},
        YamlCase{"wrist0/sensor.yaml", "position_noise_m", "noise", "\"position_noise_m\" is mi",
                 1},
        YamlCase{"wrist0/sensor.yaml", "orientation_noise_rad", "noise", "orientation_noise", 1},
        YamlCase{"em0/sensor.yaml", "uniform", "flat", "expected gaussian or uniform"},
        YamlCase{"em0/sensor.yaml", "distance_from_tip_m: 0.02", "distance_from_tip_m: 0.7",
                 "expected at most the shaft's length"},
        YamlCase{"em0/sensor.yaml", "position_noise_m: 0", "position_noise_m: -1", "not below 0"},
        YamlCase{"strain0/sensor.yaml", "[0.12, 0.5]", "[0.12]", "expected 2 numbers"},
        YamlCase{"strain0/sensor.yaml", "[0.12, 0.5]", "[0.5, 0.12]", "expected 0 <= s1 < s2"},
        YamlCase{"strain0/sensor.yaml", "[0.12, 0.5]", "[0.12, 0.61]", "the shaft's length 0.6"},
        YamlCase{"load0/sensor.yaml", "force_noise_N", "noise_N", "\"force_noise_N\" is missing",
                 1},
        YamlCase{"vision0/sensor.yaml", "direction_noise_rad", "d", "direction_noise_rad\" is", 1},
        YamlCase{"tags0/sensor.yaml", "id: 0", "id: 3", "tag 3 is there twice"},
        YamlCase{"tags0/sensor.yaml", "size_m: 0.005", "size_m: -1", "expected a number above 0"},
        YamlCase{"tags0/sensor.yaml", "rows: 4", "rows: 3", "expected 4 rows and 4 cols"},
        YamlCase{"tags0/sensor.yaml", "family", "fam", "key \"family\" is missing", 1}));

INSTANTIATE_TEST_SUITE_P(
    CameraYaml, RejectsYaml,
    ::testing::Values(
        YamlCase{"cam0/sensor.yaml", ", -0]", "]",
                 "found 3 coefficients, expected 4 (k1, k2, p1, p2) for the model radial-tan"},
        YamlCase{"cam0/sensor.yaml", "radial-tangential", "opencv",
                 "found 4 coefficients, expected 5, 8 or 12 for the model opencv", 8},
        YamlCase{"cam0/sensor.yaml", "radial-tangential", "fov",
                 "expected radial-tangential, open"},
        YamlCase{"cam0/sensor.yaml", "pinhole", "omni", "expected pinhole"},
        YamlCase{"cam1/sensor.yaml", "pinhole", "omni", "expected pinhole"},
        YamlCase{"cam0/sensor.yaml", "[32, 24]", "[32]", "expected 2 numbers"},
        YamlCase{"cam0/sensor.yaml", "[32, 24]", "[32.5, 24]", "in whole pixels"},
        YamlCase{"cam0/sensor.yaml", "[32, 24]", "[0, 24]", "in whole pixels"},
        YamlCase{"cam0/sensor.yaml", "intrinsics: [", "intrinsics: [1, ", "expected 4 numbers"},
        YamlCase{"cam0/sensor.yaml", "intrinsics: [", "intrinsics: [-", "expected both above 0"},
        YamlCase{"cam0/sensor.yaml", "11.9]", "111.9]", "expected it inside the image of 32 x 24"},
        YamlCase{"cam0/sensor.yaml", "intrinsics", "K", "key \"intrinsics\" is missing", 1},
        YamlCase{"cam0/sensor.yaml", "gamma: 2.2", "gamma: 0", "expected a number above 0"},
        YamlCase{"cam0/sensor.yaml", "data: [", "data: [0, ", "expected 16 numbers"},
        YamlCase{"cam0/sensor.yaml", "data: [", "data: [1.5e1 #", "not YAML", 11},
        YamlCase{"cam0/sensor.yaml", "0, 0, 0, 1]", "0, 0, 0, 2]", "expected 0, 0, 0, 1 as the la"},
        YamlCase{"cam0/sensor.yaml", "T_RC", "T_BS", "key \"T_RC\" is missing", 1}));

TEST(RejectsRotation, ThatIsMirroredOrScaled) {
  const TemporaryFolder folder;
  for (const char* data : {"-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1",
                           "1.001, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1",
                           "0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1"}) {
    WriteSample(folder.path());
    const auto file = folder / "cam0/sensor.yaml";
    const int line = Replace(file, "T_RC: {",
                             fmt::format("T_RC: {{rows: 4, cols: 4, data: [{}]}}\n"
                                         "comment2: {{",
                                         data));
    EXPECT_THAT(Failure(folder.path()), HasSubstr(fmt::format("sensor.yaml:{}: T_RC.data", line)));
    EXPECT_THAT(Failure(folder.path()), HasSubstr("expected a rotation"));
  }
}

TEST(RejectsFolder, ThatIsNoRecording) {
  const TemporaryFolder folder;
  EXPECT_THAT(Failure(folder / "none"), HasSubstr("none: no such folder"));
  EXPECT_THAT(Failure(folder.path()), HasSubstr("recording.yaml: no such file"));
  flextip::test_support::WriteText(folder / "recording.yaml", "");
  EXPECT_THAT(Failure(folder.path()), HasSubstr("recording.yaml:1: expected a mapping"));
  WriteSample(folder.path());
  for (const char* sensor : {"wrist0", "em1", "cam0", "tags0", "vision0"}) {
    WriteSample(folder.path());
    std::filesystem::remove(folder.path() / sensor / "sensor.yaml");
    EXPECT_THAT(Failure(folder.path()),
                HasSubstr(fmt::format("{}/sensor.yaml: no such file", sensor)));
  }
}

TEST(CarriesOn, WithUnknownKeysAndFoldersReported) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  std::filesystem::create_directory(folder / "em2");
  const int line = Replace(folder / "cam0/sensor.yaml", "gamma", "gama");
  const auto result = ReadRecording(folder.path());
  EXPECT_FALSE(result.recording.cam0->calibration.gamma.has_value());
  EXPECT_THAT(result.warnings,
              ::testing::ElementsAre(
                  HasSubstr(fmt::format("cam0/sensor.yaml:{}: unknown key \"gama\"", line)),
                  HasSubstr("em2: not a known sensor")));
}

TEST(CarriesOn, WithATornLastLineInAnyStream) {
  for (const char* sensor : {"wrist0", "em0", "strain0", "cam0", "vision0"}) {
    const TemporaryFolder folder;
    WriteSample(folder.path());
    const auto file = folder.path() / sensor / "data.csv";
    const std::string text = flextip::test_support::ReadText(file);
    flextip::test_support::WriteText(file, text.substr(0, text.size() - 3));
    const auto result = ReadRecording(folder.path());
    EXPECT_EQ(result.torn_lines, 1) << sensor;
    EXPECT_THAT(result.warnings, ::testing::ElementsAre(HasSubstr(fmt::format(
                                     "{}/data.csv:7: skipped a torn last line", sensor))));
  }
}

TEST(CarriesOn, WithLostTipsThatHoldNumbers) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const auto file = folder / "vision0/data.csv";
  const std::string time = Line(file, 4).substr(0, Line(file, 4).find(','));
  ReplaceLine(file, 4, time + ",1,2,3,-1,0,0,1,0,1,,,,lost");
  const auto tip = ReadRecording(folder.path()).recording.vision0->tips.at(2).value;
  EXPECT_EQ(tip.status, TipStatus::kLost);
  EXPECT_EQ(tip.p_RE, Eigen::Vector3d::Zero());
  EXPECT_EQ(tip.covariance_m2, Eigen::Matrix3d::Zero());
}

TEST(CarriesOn, WithRotationsPrintedInFewDigits) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  const auto file = folder / "em0/data.csv";
  ReplaceLine(file, 2, "1699999999000000000,0,0,0,0.7071,0.7071,0,0");
  const auto q = ReadRecording(folder.path()).recording.em0->samples.at(0).value.q_RS;
  EXPECT_NEAR(q.norm(), 1.0, 1e-15);
  EXPECT_NEAR(q.x(), std::sqrt(0.5), 1e-15);
}

}  // namespace
}  // namespace flextip
