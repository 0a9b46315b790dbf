// Kalibr's camchains.
#include "tests/recording/camera_format_test.h"

namespace flextip {
namespace {

using flextip::test_support::CameraFormats;
using flextip::test_support::Names;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// As kalibr_calibrate_cameras and kalibr_calibrate_imu_camera leave it.
const char* kCamchain = R"(cam0:
  T_cam_imu:
  - [0.0, -1.0, 0.0, 0.1]
  - [1.0, 0.0, 0.0, -0.02]
  - [0.0, 0.0, 1.0, 0.003]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
  distortion_model: radtan
  intrinsics: [458.654, 457.296, 367.215, 248.375]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: 0.0
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [-0.01, 0.02, -0.003, 0.0004]
  distortion_model: equidistant
  intrinsics: [457.587, 456.134, 379.999, 255.238]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
)";

TEST_F(CameraFormats, ReadsAKalibrCamchain) {
  const auto d = Read(kCamchain, {.camera = "cam0"});
  EXPECT_THAT(LossesIn(CameraFormat::kKalibr, d), IsEmpty());
  EXPECT_EQ(d.calibration.distortion, Distortion::kRadialTangential);
  EXPECT_THAT(d.calibration.distortion_coefficients,
              ElementsAre(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05));
  EXPECT_EQ(d.calibration.fv_px, 457.296);
  EXPECT_EQ(d.calibration.cu_px, 367.215);
  EXPECT_EQ(d.calibration.width_px, 752);
  EXPECT_EQ(d.rostopic, "/cam0/image_raw");
  ASSERT_TRUE(d.T_BS);  // the camera in the imu's frame: R' (0 - p)
  EXPECT_LT((d.T_BS->p - Eigen::Vector3d(0.02, 0.1, -0.003)).norm(), 1e-15);
  EXPECT_THAT(Names(LossesIn(CameraFormat::kRos, d)), ElementsAre("pose"));

  const auto right = Read(kCamchain, {.camera = "cam1"});
  EXPECT_EQ(right.calibration.distortion, Distortion::kEquidistant);
  EXPECT_THAT(Names(right.not_kept), ElementsAre("pose"));
  EXPECT_THAT(Refusal(kCamchain), HasSubstr("cam0, cam1"));
  EXPECT_THAT(Refusal(kCamchain, {.camera = "cam2"}), HasSubstr("cam2: no such camera"));
}

TEST_F(CameraFormats, RefusesKalibrsOtherModels) {
  const CameraFileChoice first{.camera = "cam0"};
  EXPECT_THAT(Refusal(With(kCamchain, "radtan", "fov"), first),
              HasSubstr("in.yaml:10: cam0.distortion_model: found \"fov\""));
  EXPECT_THAT(Refusal(With(kCamchain, "pinhole", "omni"), first),
              HasSubstr("in.yaml:8: cam0.camera_model: found \"omni\""));
  EXPECT_THAT(Refusal(With(kCamchain, "[0.0, -1.0, 0.0, 0.1]", "[0.0, -1.0, 0.1]"), first),
              HasSubstr("cam0.T_cam_imu"));
  EXPECT_THAT(Names(Read(With(kCamchain, "imu: 0.0", "imu: 0.004"), first).not_kept),
              ElementsAre("timeshift_cam_imu"));
  EXPECT_THAT(
      Names(Read(With(kCamchain, "  rostopic", "  line_delay: 1\n  rostopic"), first).not_kept),
      ElementsAre("line_delay"));
  const auto plain = Read(With(kCamchain, "radtan", "none"), first).calibration;
  EXPECT_THAT(plain.distortion_coefficients, ElementsAre(0, 0, 0, 0));
}

}  // namespace
}  // namespace flextip
