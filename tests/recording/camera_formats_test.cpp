// What becomes of a camera between the formats of camera files.
#include "core/rotation.h"
#include "tests/recording/camera_format_test.h"

namespace flextip {
namespace {

using flextip::test_support::Awkward;
using flextip::test_support::CameraFormats;
using flextip::test_support::ExpectSameLens;
using flextip::test_support::Names;
using flextip::test_support::ReadText;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(CameraFormats, EveryLensThatFitsComesBackBitForBit) {
  struct Case {
    CameraFormat format;
    Distortion distortion;
    std::size_t terms;
  };
  using enum CameraFormat;
  for (const Case& c : {Case{kEuroc, Distortion::kRadialTangential, 4},
                        {kEuroc, Distortion::kOpenCv, 12},
                        {kEuroc, Distortion::kEquidistant, 4},
                        {kKalibr, Distortion::kRadialTangential, 4},
                        {kKalibr, Distortion::kEquidistant, 4},
                        {kRos, Distortion::kRadialTangential, 4},
                        {kRos, Distortion::kOpenCv, 5},
                        {kRos, Distortion::kOpenCv, 8},
                        {kRos, Distortion::kEquidistant, 4},
                        {kOpenCv, Distortion::kRadialTangential, 4},
                        {kOpenCv, Distortion::kOpenCv, 5},
                        {kOpenCv, Distortion::kOpenCv, 8},
                        {kOpenCv, Distortion::kOpenCv, 12},
                        {kOpenCv, Distortion::kEquidistant, 4}}) {
    SCOPED_TRACE(fmt::format("{} {} {}", Name(c.format), static_cast<int>(c.distortion), c.terms));
    const auto wrote = Awkward(c.distortion, c.terms);
    EXPECT_THAT(LossesIn(c.format, wrote), IsEmpty());
    const auto file = folder / (c.format == kOpenCv ? "a.yml" : "a.yaml");
    WriteCameraDescription(file, c.format, wrote);
    EXPECT_EQ(GuessCameraFormat(file), c.format);
    const auto read = ReadCameraDescription(file, c.format);
    ExpectSameLens(read.calibration, wrote.calibration);
    EXPECT_EQ(read.comment, wrote.comment);
    EXPECT_EQ(read.camera_name, "left");
    EXPECT_EQ(read.rostopic, wrote.rostopic);
    EXPECT_EQ(read.calibration.rate_hz, 29.97);
    EXPECT_THAT(read.not_kept, IsEmpty());
    EXPECT_THAT(read.notes, IsEmpty());
  }
}

TEST_F(CameraFormats, WhatDoesNotFitIsNamedAndNotWritten) {
  using enum CameraFormat;
  auto d = Awkward(Distortion::kOpenCv, 12);
  EXPECT_THAT(LossesIn(kOpenCv, d), IsEmpty());
  for (const auto format : {kKalibr, kRos}) {
    EXPECT_THAT(Names(LossesIn(format, d)), ElementsAre(""));
    EXPECT_THROW(WriteCameraDescription(folder / "a.yaml", format, d), InputError);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.yaml"));
  d = Awkward(Distortion::kOpenCv, 8);
  EXPECT_THAT(Names(LossesIn(kKalibr, d)), ElementsAre(""));
  std::fill(d.calibration.distortion_coefficients.begin() + 4,
            d.calibration.distortion_coefficients.end(), 0.0);
  EXPECT_THAT(LossesIn(kKalibr, d), IsEmpty());  // the same lens with four
  d.calibration.gamma = 2.2;
  d.has_T_RC = true;
  d.calibration.T_RC.p.x() = 0.1;
  d.T_BS = Pose{ExpRotation({0, 0, 1}), {0, 0, 0}};
  EXPECT_THAT(Names(LossesIn(kKalibr, d)), ElementsAre("gamma", "pose"));
  EXPECT_THAT(Names(LossesIn(kRos, d)), ElementsAre("gamma", "pose", "pose"));
  EXPECT_THAT(LossesIn(kEuroc, d), IsEmpty());
}

// PyYAML, which Kalibr and ROS read with, takes 1e-05 for a text: numbers need a point.
TEST_F(CameraFormats, NumbersAreFloatsToPython) {
  const auto d = Awkward(Distortion::kRadialTangential, 4);
  for (const auto format : {CameraFormat::kKalibr, CameraFormat::kRos}) {
    WriteCameraDescription(folder / "a.yaml", format, d);
    EXPECT_THAT(ReadText(folder / "a.yaml"), HasSubstr("1.0e-05"));
    EXPECT_THAT(ReadText(folder / "a.yaml"), HasSubstr("951.0,"));
  }
}

TEST_F(CameraFormats, GuessesNothingElse) {
  EXPECT_THAT(Refusal("family: tag36h11\n"), HasSubstr("not a camera file"));
  EXPECT_THAT(Refusal("[3, 4]\n"), HasSubstr("in.yaml"));
  EXPECT_THAT(Refusal(""), HasSubstr("in.yaml"));
  EXPECT_THAT(Refusal("%YAML:1.0\n---\n"), HasSubstr("in.yaml:3: expected a mapping"));
  EXPECT_THAT(Refusal("%YAML:1.0\n---\na: 1\n"), HasSubstr("camera_matrix"));
  EXPECT_THAT(Refusal("<opencv_storage>\n"), HasSubstr("in.yaml"));
}

}  // namespace
}  // namespace flextip
