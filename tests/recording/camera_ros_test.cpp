// ROS's camera_info files.
#include "tests/recording/camera_format_test.h"

namespace flextip {
namespace {

using flextip::test_support::CameraFormats;
using flextip::test_support::Names;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// As the camera_calibration package of ROS saves it.
const char* kCameraInfo = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.78316, 0.      , 305.50394,
           0.      , 437.30279, 243.73725,
           0.      , 0.      , 1.      ]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.36152, 0.11080, -0.001175, 0.002097, 0.      ]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1., 0., 0.,
         0., 1., 0.,
         0., 0., 1.]
projection_matrix:
  rows: 3
  cols: 4
  data: [356.78983, 0.      , 302.97842, 0.      ,
           0.      , 399.91364, 242.61646, 0.      ,
           0.      , 0.      , 1.      , 0.      ]
)";

TEST_F(CameraFormats, ReadsRosCameraInfo) {
  const auto d = Read(kCameraInfo);
  EXPECT_EQ(d.camera_name, "narrow_stereo");
  EXPECT_EQ(d.calibration.fu_px, 438.78316);
  EXPECT_EQ(d.calibration.cv_px, 243.73725);
  EXPECT_EQ(d.calibration.height_px, 480);
  EXPECT_EQ(d.calibration.distortion, Distortion::kRadialTangential);  // k3 is 0
  EXPECT_THAT(d.calibration.distortion_coefficients,
              ElementsAre(-0.36152, 0.11080, -0.001175, 0.002097));
  EXPECT_THAT(d.notes, ElementsAre(HasSubstr("projection_matrix")));
  for (const auto format : {CameraFormat::kEuroc, CameraFormat::kKalibr, CameraFormat::kOpenCv}) {
    EXPECT_THAT(LossesIn(format, d), IsEmpty());
  }
  const auto bent = Read(With(kCameraInfo, "0.002097, 0.  ", "0.002097, 0.25"));
  EXPECT_EQ(bent.calibration.distortion, Distortion::kOpenCv);
  EXPECT_THAT(Names(LossesIn(CameraFormat::kKalibr, bent)), ElementsAre(""));
}

TEST_F(CameraFormats, NamesWhatRosSaysBeyondTheCamera) {
  const auto names = [&](const std::string& text) { return Names(Read(text).not_kept); };
  EXPECT_THAT(names(With(kCameraInfo, "data: [1.,", "data: [0.999,")),
              ElementsAre("rectification_matrix"));
  EXPECT_THAT(names(With(kCameraInfo, "302.97842, 0. ", "302.97842, -40.")),
              ElementsAre("projection_matrix"));
  const std::string info = kCameraInfo;
  EXPECT_THAT(names(info + "binning_x: 2\nbinning_y: 2\n"), ElementsAre("binning", "binning"));
  EXPECT_THAT(names(info + "binning_x: 0\nbinning_y: 1\n"), IsEmpty());
  EXPECT_THAT(names(info + "roi: {x_offset: 0, y_offset: 8, height: 400, width: 640}\n"),
              ElementsAre("roi"));
  EXPECT_THAT(
      names(info + "roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}\n"),
      IsEmpty());
  EXPECT_THAT(Refusal(With(kCameraInfo, "438.78316, 0. ", "438.78316, 0.5")), HasSubstr("skew"));
  EXPECT_THAT(Refusal(With(kCameraInfo, "plumb_bob", "thin_prism")),
              HasSubstr("in.yaml:10: distortion_model"));
  EXPECT_THAT(Refusal(With(kCameraInfo, "305.50394", "905.5")), HasSubstr("inside the image"));
}

}  // namespace
}  // namespace flextip
