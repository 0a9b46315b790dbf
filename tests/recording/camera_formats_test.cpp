// Camera files as other programs write them, and what becomes of a camera between the formats.
#include "recording/camera_formats.h"

#include <gmock/gmock.h>

#include <bit>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/rotation.h"
#include "recording/camera_file.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::testing::ReadText;
using flextip::testing::TemporaryFolder;
using flextip::testing::WriteText;
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

// As samples/cpp/tutorial_code/calib3d/camera_calibration of OpenCV writes it.
const char* kOpenCv = R"(%YAML:1.0
---
calibration_time: "Sun Nov  1 12:00:00 2020"
nr_of_frames: 25
image_width: 640
image_height: 480
board_width: 9
board_height: 6
square_size: 5.0000000000000000e+01
fix_aspect_ratio: 1.
flags: 10
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 6.5746697944293521e+02, 0., 3.1950000000000000e+02, 0.,
       6.5746697944293521e+02, 2.3950000000000000e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -4.1802327176423804e-01, 5.0715244063187526e-01, 0., 0.,
       -5.7843597214487474e-01 ]
avg_reprojection_error: 3.8441346462381665e-01
)";

class CameraFormats : public ::testing::Test {
 protected:
  CameraDescription Read(const std::string& text, const CameraFileChoice& choice = {}) const {
    WriteText(folder / "in.yaml", text);
    return ReadCameraDescription(folder / "in.yaml", GuessCameraFormat(folder / "in.yaml"), choice);
  }
  std::string Refusal(const std::string& text, const CameraFileChoice& choice = {}) const {
    try {
      (void)Read(text, choice);
    } catch (const InputError& error) {
      return error.what();
    }
    return "read without an error";
  }
  static std::string With(std::string text, const std::string& from, const std::string& to) {
    EXPECT_THAT(text, HasSubstr(from));
    return text.replace(text.find(from), from.size(), to);
  }
  TemporaryFolder folder;
};

std::vector<std::string> Names(const std::vector<CameraLoss>& losses) {
  std::vector<std::string> names;
  for (const auto& loss : losses) names.push_back(loss.name);
  return names;
}

void ExpectSameLens(const CameraCalibration& a, const CameraCalibration& b) {
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  EXPECT_EQ(a.fu_px, b.fu_px);
  EXPECT_EQ(a.fv_px, b.fv_px);
  EXPECT_EQ(a.cu_px, b.cu_px);
  EXPECT_EQ(a.cv_px, b.cv_px);
  EXPECT_EQ(a.distortion, b.distortion);
  EXPECT_EQ(a.distortion_coefficients, b.distortion_coefficients);
}

CameraDescription Awkward(Distortion distortion, std::size_t terms) {
  CameraDescription d;
  CameraCalibration& c = d.calibration;
  c.width_px = 1280, c.height_px = 720;
  c.fu_px = 2852.0 / 3.0, c.fv_px = 951, c.cu_px = 640.1, c.cv_px = 1e-05;
  c.distortion = distortion;
  c.distortion_coefficients.clear();
  for (std::size_t i = 0; i < terms; ++i) {
    c.distortion_coefficients.push_back(std::pow(-0.1, static_cast<double>(i)) / 3.0);
  }
  d.comment = "left \"eye\": a\\b";
  d.camera_name = "left";
  d.rostopic = "/left/image_raw";
  d.has_rate = true;
  c.rate_hz = 29.97;
  return d;
}

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

TEST_F(CameraFormats, ReadsWhatOpenCvsProgramWrites) {
  const auto d = Read(kOpenCv);
  EXPECT_EQ(d.calibration.fu_px, 657.46697944293521);
  EXPECT_EQ(d.calibration.cv_px, 239.5);
  EXPECT_EQ(d.calibration.distortion, Distortion::kOpenCv);
  EXPECT_EQ(d.calibration.distortion_coefficients.at(4), -0.57843597214487474);
  EXPECT_THAT(d.notes, ElementsAre(HasSubstr("avg_reprojection_error")));
  EXPECT_THAT(Refusal(With(kOpenCv, "image_width: 640\n", "")), HasSubstr("--resolution"));
  EXPECT_EQ(Refusal(With(kOpenCv, "image_width: 640\n", ""), {"", 640, 480}),
            "read without an error");
  EXPECT_THAT(Refusal(With(kOpenCv, "camera_matrix", "camera_matrics")),
              HasSubstr("camera_matrix"));
}

// cv::FileStorage is the other party here: it reads what was written and writes what is read.
TEST_F(CameraFormats, OpenCvItselfReadsAndWritesTheSameNumbers) {
  for (const char* name : {"a.yml", "a.xml", "a.json"}) {
    const auto file = folder / name;
    for (const std::size_t terms : {4U, 5U, 8U, 12U}) {
      const auto d =
          Awkward(terms == 4 ? Distortion::kRadialTangential : Distortion::kOpenCv, terms);
      WriteCameraDescription(file, CameraFormat::kOpenCv, d);
      cv::FileStorage in(file.string(), cv::FileStorage::READ);
      const cv::Mat_<double> K = in["camera_matrix"].mat(), k = in["distortion_coefficients"].mat();
      EXPECT_EQ(K(0, 0), d.calibration.fu_px);
      EXPECT_EQ(K(1, 2), d.calibration.cv_px);
      EXPECT_EQ(std::vector<double>(k.begin(), k.end()), d.calibration.distortion_coefficients);
      EXPECT_EQ(GuessCameraFormat(file), CameraFormat::kOpenCv);
    }
  }
  const auto write = [&](const cv::Mat& terms) {
    cv::FileStorage out((folder / "b.yml").string(), cv::FileStorage::WRITE);
    out << "image_width" << 640 << "image_height" << 480 << "camera_matrix"
        << cv::Mat(cv::Matx33f(500, 0, 320.5F, 0, 501, 240, 0, 0, 1)) << "distortion_coefficients"
        << terms;
  };
  const auto read = [&] {
    return ReadCameraDescription(folder / "b.yml", CameraFormat::kOpenCv).calibration;
  };
  write(cv::Mat_<double>(14, 1, 0.0));
  EXPECT_EQ(read().distortion_coefficients.size(), 12U);
  EXPECT_EQ(read().cu_px, 320.5);
  write(cv::Mat_<double>(1, 14, 0.1));
  EXPECT_THROW(read(), InputError);
  write(cv::Mat_<double>(1, 6, 0.1));
  EXPECT_THROW(read(), InputError);
}

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
  EXPECT_THAT(Refusal("%YAML:1.0\n---\n"), HasSubstr("camera_matrix"));
  EXPECT_THAT(Refusal("<opencv_storage>\n"), HasSubstr("in.yaml"));
}

}  // namespace
}  // namespace flextip
