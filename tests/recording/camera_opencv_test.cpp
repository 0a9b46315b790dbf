// OpenCV's camera files, beside OpenCV itself.
#include <opencv2/core.hpp>

#include "tests/recording/camera_format_test.h"

namespace flextip {
namespace {

using flextip::test_support::Awkward;
using flextip::test_support::CameraFormats;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST_F(CameraFormats, ReadsWhatOpenCvsProgramWrites) {
  const auto d = Read(kOpenCv);
  EXPECT_EQ(d.calibration.fu_px, 657.46697944293521);
  EXPECT_EQ(d.calibration.cv_px, 239.5);
  EXPECT_EQ(d.calibration.distortion, Distortion::kOpenCv);
  EXPECT_EQ(d.calibration.distortion_coefficients.at(4), -0.57843597214487474);
  EXPECT_THAT(d.notes, ElementsAre(HasSubstr("avg_reprojection_error")));
  EXPECT_THAT(Refusal(With(kOpenCv, "image_width: 640\n", "")),
              HasSubstr("no resolution was given"));
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

TEST_F(CameraFormats, AMatrixOfAbsurdSizeIsRefusedBeforeItsMemoryIsAskedFor) {
  for (const auto& [size, says] :
       {std::pair("rows: 30000\n   cols: 30000",
                  "camera_matrix: found 30000 rows and 30000 columns"),
        std::pair("rows: 3\n   cols: -3", "camera_matrix: found 3 rows and -3 columns"),
        std::pair("sizes: [ 30000, 30000 ]", "camera_matrix: expected a matrix of rows"),
        // OpenCV takes a text for the largest whole number, and rounds a fraction.
        std::pair("rows: 1\n   cols: many", "camera_matrix: expected a matrix of rows"),
        std::pair("rows: 30000.\n   cols: 30000.", "camera_matrix: expected a matrix of rows")}) {
    const std::string matrix =
        fmt::format("camera_matrix: !!opencv-matrix\n   {}\n   dt: d\n   data: [ 1. ]\n", size);
    EXPECT_THAT(Refusal("%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n" + matrix),
                HasSubstr(says));
  }
}

// OpenCV's parser throws more than its own exceptions.
TEST_F(CameraFormats, ABrokenKeyIsRefused) {
  EXPECT_THAT(Refusal("%YAML:1.0\n---\nimage\x8a_width: 640\nimage_height: 480\n"
                      "cameraWmatrix: !!opencv-matrix\n   rows: 100000\n   cols: 100000\n"
                      "   :dt d\n   data: [ 1. ]\n"),
              HasSubstr("in.yaml: "));
}

}  // namespace
}  // namespace flextip
