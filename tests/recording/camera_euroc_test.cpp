// EuRoC's sensor.yaml.
#include "recording/cameras/camera_file.h"
#include "tests/recording/camera_format_test.h"

namespace flextip {
namespace {

using flextip::test_support::Awkward;
using flextip::test_support::CameraFormats;
using flextip::test_support::ExpectSameLens;
using flextip::test_support::ReadText;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// As the EuRoC MAV dataset has it.
const char* kEuroc = R"(# General sensor definitions.
sensor_type: camera
comment: VI-Sensor cam0 (MT9M034)

# Sensor extrinsics wrt. the body-frame.
T_BS:
  cols: 4
  rows: 4
  data: [0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,
         0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,
        -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,
         0.0, 0.0, 0.0, 1.0]

# Camera specific definitions.
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)";

TEST_F(CameraFormats, ReadsEurocsOwnFile) {
  const auto d = Read(kEuroc);
  EXPECT_EQ(d.comment, "VI-Sensor cam0 (MT9M034)");
  EXPECT_EQ(d.calibration.rate_hz, 20);
  EXPECT_FALSE(d.has_T_RC);
  ASSERT_TRUE(d.T_BS);
  EXPECT_EQ(d.T_BS->p.z(), 0.00981073058949);
  EXPECT_THAT(d.not_kept, IsEmpty());
  EXPECT_THAT(LossesIn(CameraFormat::kKalibr, d), IsEmpty());
  // T_cam_imu is its inverse.
  WriteCameraDescription(folder / "camchain.yaml", CameraFormat::kKalibr, d);
  const auto back = ReadCameraDescription(folder / "camchain.yaml", CameraFormat::kKalibr);
  EXPECT_LT((back.T_BS->Matrix() - d.T_BS->Matrix()).norm(), 1e-12);  // the file has 12 digits
  EXPECT_THAT(ReadText(folder / "camchain.yaml"), HasSubstr("T_cam_imu:\n  - [0.01486"));
}

// A recording reads it as it is.
TEST_F(CameraFormats, WhatIsWrittenAsEurocIsAnOrdinarySensorFile) {
  auto d = Awkward(Distortion::kOpenCv, 5);
  d.has_T_RC = true;
  d.calibration.gamma = 2.2;
  d.calibration.T_RC.p = {0.1, 0.2, 0.3};
  WriteCameraDescription(folder / "sensor.yaml", CameraFormat::kEuroc, d);
  ReadLog log;
  const auto camera = ReadCameraCalibration(folder / "sensor.yaml", &log);
  EXPECT_THAT(log.warnings, IsEmpty());
  ExpectSameLens(camera, d.calibration);
  EXPECT_EQ(camera.T_RC.p, d.calibration.T_RC.p);
  EXPECT_EQ(camera.gamma, 2.2);
}

}  // namespace
}  // namespace flextip
