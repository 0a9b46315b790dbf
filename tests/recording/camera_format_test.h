// What the tests of camera files share.
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "recording/cameras/camera_formats.h"
#include "tests/recording/sample_recording.h"

namespace flextip::test_support {

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
    EXPECT_THAT(text, ::testing::HasSubstr(from));
    return text.replace(text.find(from), from.size(), to);
  }
  TemporaryFolder folder;
};

inline std::vector<std::string> Names(const std::vector<CameraLoss>& losses) {
  std::vector<std::string> names;
  for (const auto& loss : losses) names.push_back(loss.name);
  return names;
}

inline void ExpectSameLens(const CameraCalibration& a, const CameraCalibration& b) {
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  EXPECT_EQ(a.fu_px, b.fu_px);
  EXPECT_EQ(a.fv_px, b.fv_px);
  EXPECT_EQ(a.cu_px, b.cu_px);
  EXPECT_EQ(a.cv_px, b.cv_px);
  EXPECT_EQ(a.distortion, b.distortion);
  EXPECT_EQ(a.distortion_coefficients, b.distortion_coefficients);
}

/// A lens of numbers that texts are awkward for.
inline CameraDescription Awkward(Distortion distortion, std::size_t terms) {
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

}  // namespace flextip::test_support
