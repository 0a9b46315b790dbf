// OpenCV's camera files, beside OpenCV itself.
#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "recording/text/text.h"
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

TEST_F(CameraFormats, XmlHasItsLinesAndTexts) {
  auto d = Awkward(Distortion::kRadialTangential, 4);
  const auto file = folder / "in.xml";
  // OpenCV takes a text that begins and ends with a quote for one that is quoted already.
  for (const char* comment : {"a < b & \"c\" > 'd'", "say \"b\"", "word", "7", "&lt;", "a "}) {
    d.comment = comment;
    WriteCameraDescription(file, CameraFormat::kOpenCv, d);
    cv::FileStorage in(file.string(), cv::FileStorage::READ);
    EXPECT_EQ(in["comment"].string(), comment);
    EXPECT_EQ(ReadCameraDescription(file, CameraFormat::kOpenCv).comment, comment);
  }
  const std::string written = ReadTextFile(file);
  const auto line =
      std::count(written.begin(), written.begin() + std::ptrdiff_t(written.find("<data>")), '\n') +
      1;
  WriteTextFile(file, With(written, "<data>", "<data>nothing "));
  try {
    ReadCameraDescription(file, CameraFormat::kOpenCv);
    ADD_FAILURE() << "read without an error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(fmt::format("in.xml:{}: camera_matrix.data: found "
                                                    "\"nothing\"",
                                                    line)));
  }
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

TEST_F(CameraFormats, AMatrixWithoutItsNumbersIsRefused) {
  for (const auto& [size, says] :
       {std::pair("rows: 30000\n   cols: 30000",
                  "in.yaml:9: camera_matrix.data: found 1 numbers, expected 30000 rows and 30000"),
        std::pair("rows: -1\n   cols: -1", "found 1 numbers, expected -1 rows and -1 columns"),
        std::pair("sizes: [ 30000, 30000 ]", "key \"camera_matrix.rows\" is missing"),
        std::pair("rows: 1\n   cols: many", "camera_matrix.cols: found \"many\""),
        std::pair("rows: 1.\n   cols: 1.", "camera_matrix.rows: found \"1.\"")}) {
    const std::string matrix =
        fmt::format("camera_matrix: !!opencv-matrix\n   {}\n   dt: d\n   data: [ 1. ]\n", size);
    EXPECT_THAT(Refusal("%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n" + matrix),
                HasSubstr(says));
  }
}

// OpenCV's parsers end a program on the first two, and on elements nested without end.
TEST_F(CameraFormats, BrokenFilesAreRefused) {
  for (const auto& [text, says] :
       {std::pair<std::string, std::string>("<?xml n=", "in.yaml:1: <? without ?>"),
        {"<?xml version=\"1.0\"?>\n<opencv_storage>\n<a b=", "in.yaml:3: expected ="},
        {"<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width~640</image_width>",
         "in.yaml:3: "},
        {"%YAML:1.0\n---\nimage\x8a_width: 640\n   :dt d\n",
         "in.yaml:3: key \"camera_matrix\" is missing"},
        {"%YAML:1.0\n---\na: " + std::string(100'000, '['), "in.yaml:3: is not YAML from here"},
        {"{\"a\": " + std::string(100'000, '['), "in.yaml:1: is not YAML from here"}}) {
    EXPECT_THAT(Refusal(text), HasSubstr(says)) << text.substr(0, 200);
  }
  std::string deep = "<?xml version=\"1.0\"?>\n";
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_THAT(Refusal(deep), HasSubstr("in.yaml:2: elements nested more than 32 deep"));
}

}  // namespace
}  // namespace flextip
