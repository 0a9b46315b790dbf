// What was found of cameras, in the place of what the recording says.
#include <gmock/gmock.h>

#include <cmath>

#include "calibration_applied.h"

namespace flextip {
namespace {

using test_support::Apply;
using test_support::ErrorOf;
using test_support::kPose;
using test_support::Plain;
using test_support::WithNumbers;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(CalibrationApply, SetsTheLens) {
  Recording r = Plain();
  Calibration c = WithNumbers("cam0.intrinsics", {900, 901, 640, 360});
  c.numbers["cam0.distortion_coefficients"] = {0.1, 0.2, 0.3, 0.4, 0.5};
  const auto applied = Apply(c, r);
  const CameraCalibration& camera = r.cam0->calibration;
  EXPECT_EQ(camera.fu_px, 900);
  EXPECT_EQ(camera.fv_px, 901);
  EXPECT_EQ(camera.cu_px, 640);
  EXPECT_EQ(camera.cv_px, 360);
  EXPECT_EQ(camera.distortion, Distortion::kOpenCv);
  EXPECT_THAT(camera.distortion_coefficients, ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5));
  EXPECT_THAT(applied.used, ElementsAre("cam0.distortion_coefficients", "cam0.intrinsics"));
  EXPECT_THAT(applied.warnings, ::testing::Contains(HasSubstr("vision0 were found without it")));
  EXPECT_THAT(ErrorOf(WithNumbers("cam0.intrinsics", {900, -1, 640, 360}), r), HasSubstr("-1"));
  EXPECT_THAT(ErrorOf(WithNumbers("cam0.distortion_coefficients", {1, 2, 3}), r),
              HasSubstr("expected 4, 5, 8 or 12"));
}

TEST(CalibrationApply, FourTermsStayThoseOfAFisheye) {
  Recording r = Plain();
  r.cam0->calibration.distortion = Distortion::kEquidistant;
  r.cam1->calibration.distortion = Distortion::kOpenCv;
  Apply(WithNumbers("cam0.distortion_coefficients", {1, 2, 3, 4}), r);
  Apply(WithNumbers("cam1.distortion_coefficients", {1, 2, 3, 4}), r);
  EXPECT_EQ(r.cam0->calibration.distortion, Distortion::kEquidistant);
  EXPECT_EQ(r.cam1->calibration.distortion, Distortion::kRadialTangential);
}

TEST(CalibrationApply, TheModelNamedIsTheModel) {
  for (const Distortion before :
       {Distortion::kRadialTangential, Distortion::kEquidistant, Distortion::kOpenCv}) {
    Recording r = Plain();
    r.cam0->calibration.distortion = r.cam1->calibration.distortion = before;
    Calibration c = WithNumbers("cam0.distortion_coefficients", {1, 2, 3, 4});
    c.texts["cam0.distortion_model"] = "equidistant";
    c.numbers["cam1.distortion_coefficients"] = {1, 2, 3, 4};
    c.texts["cam1.distortion_model"] = "radial-tangential";
    const auto applied = Apply(c, r);
    EXPECT_EQ(r.cam0->calibration.distortion, Distortion::kEquidistant);
    EXPECT_EQ(r.cam1->calibration.distortion, Distortion::kRadialTangential);
    EXPECT_THAT(applied.used, ::testing::Contains("cam0.distortion_model"));
  }
  const Recording r = Plain();
  Calibration c = WithNumbers("cam0.distortion_coefficients", {1, 2, 3, 4, 5});
  c.texts["cam0.distortion_model"] = "equidistant";
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("cam0.distortion_coefficients: found 5 coefficients, "
                                       "expected 4 (k1, k2, k3, k4)"));
  c.texts["cam0.distortion_model"] = "fish";
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("cam0.distortion_model: found \"fish\""));
  c.numbers.clear();
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("no distortion_coefficients"));
  c.texts = {{"em0.field_model", "cubic"}};
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("em0.field_model: unknown name"));
}

// Written from one camera, read and put into a recording that has another lens.
TEST(CalibrationApply, EveryLensComesThroughAFile) {
  const test_support::TemporaryFolder folder;
  const std::vector<std::pair<Distortion, int>> lenses = {{Distortion::kRadialTangential, 4},
                                                          {Distortion::kEquidistant, 4},
                                                          {Distortion::kOpenCv, 5},
                                                          {Distortion::kOpenCv, 8},
                                                          {Distortion::kOpenCv, 12}};
  for (const auto& [from, terms] : lenses) {
    CameraCalibration lens;
    lens.fu_px = 1000.0 / 3;
    lens.fv_px = 333;
    lens.cu_px = 17.1;
    lens.cv_px = 11;
    lens.distortion = from;
    lens.distortion_coefficients.clear();
    for (int i = 0; i < terms; ++i) lens.distortion_coefficients.push_back(std::sin(1.0 + i));
    Calibration written;
    AddLens("cam1", lens, written);
    WriteCalibration(folder / "c.yaml", written);
    for (const auto& other : lenses) {
      Recording r = Plain();
      r.cam1->calibration.distortion = other.first;
      r.cam1->calibration.distortion_coefficients.assign(other.second, 0.5);
      Apply(ReadCalibration(folder / "c.yaml"), r);
      const CameraCalibration& read = r.cam1->calibration;
      EXPECT_EQ(read.distortion, from);
      EXPECT_EQ(read.distortion_coefficients, lens.distortion_coefficients);
      EXPECT_EQ(read.fu_px, lens.fu_px);
      EXPECT_EQ(read.cu_px, lens.cu_px);
    }
  }
}

TEST(CalibrationApply, TheSecondCameraIsPlacedByTheFirst) {
  const Pose T_C0C1{ExpRotation({0.01, -0.02, 0.03}), {0.005, 0.0001, -0.0002}};
  Calibration stereo, hand_eye, both;
  stereo.poses["cam1.T_C0C1"] = both.poses["cam1.T_C0C1"] = T_C0C1;
  hand_eye.poses["cam0.T_RC"] = both.poses["cam0.T_RC"] = kPose;
  const Recording before = Plain();
  Recording alone = before;
  const auto applied = Apply(stereo, alone);
  EXPECT_THAT(applied.used, ElementsAre("cam1.T_C0C1"));
  EXPECT_THAT(applied.warnings, ::testing::Contains(HasSubstr("vision0 were found without it")));
  EXPECT_TRUE(alone.cam1->calibration.T_RC.Matrix().isApprox(
      (before.cam0->calibration.T_RC * T_C0C1).Matrix()));
  EXPECT_EQ(alone.cam0->calibration.T_RC.Matrix(), before.cam0->calibration.T_RC.Matrix());

  const Eigen::Matrix4d expected = (kPose * T_C0C1).Matrix();
  Recording first = before, last = before, together = before;
  Apply(stereo, first);
  Apply(hand_eye, first);
  Apply(hand_eye, last);
  Apply(stereo, last);
  Apply(both, together);
  for (const Recording* r : {&first, &last, &together}) {
    EXPECT_TRUE(r->cam0->calibration.T_RC.Matrix().isApprox(kPose.Matrix()));
    EXPECT_TRUE(r->cam1->calibration.T_RC.Matrix().isApprox(expected));
  }
}

TEST(CalibrationApply, TipsSeenByTheSecondCameraGoWithIt) {
  Recording before = Plain();
  before.vision0->camera = "cam1";
  for (const bool by_stereo : {true, false}) {
    Recording r = before;
    Calibration c;
    c.poses[by_stereo ? "cam1.T_C0C1" : "cam0.T_RC"] = kPose;
    Apply(c, r);
    for (std::size_t i = 0; i < r.vision0->tips.size(); ++i) {
      EXPECT_TRUE((r.cam1->calibration.T_RC.Inverse() * r.vision0->tips[i].value.p_RE)
                      .isApprox(before.cam1->calibration.T_RC.Inverse() *
                                before.vision0->tips[i].value.p_RE));
    }
  }
}

TEST(CalibrationApply, ACameraTakesItsTipsAndTheOtherEyeAlong) {
  const Recording before = Plain();
  Recording r = before;
  Calibration c;
  c.poses["cam0.T_RC"] = kPose;
  Apply(c, r);
  const Pose to_camera = before.cam0->calibration.T_RC.Inverse();
  EXPECT_TRUE(r.cam0->calibration.T_RC.Matrix().isApprox(kPose.Matrix()));
  EXPECT_TRUE((kPose.Inverse() * r.cam1->calibration.T_RC)
                  .Matrix()
                  .isApprox((to_camera * before.cam1->calibration.T_RC).Matrix()));
  for (std::size_t i = 0; i < r.vision0->tips.size(); ++i) {
    const TipObservation& was = before.vision0->tips[i].value;
    const TipObservation& is = r.vision0->tips[i].value;
    // In the camera nothing has changed.
    EXPECT_TRUE((kPose.Inverse() * is.p_RE).isApprox(to_camera * was.p_RE));
    EXPECT_TRUE((kPose.R.transpose() * *is.d_RE).isApprox(to_camera.R * *was.d_RE));
    EXPECT_TRUE((kPose.R.transpose() * is.covariance_m2 * kPose.R)
                    .isApprox(to_camera.R * was.covariance_m2 * to_camera.R.transpose()));
  }
}

TEST(CalibrationApply, TheCovarianceSaysHowWellTipsAreRegistered) {
  Recording r = Plain();
  for (auto& tip : r.vision0->tips) tip.value.p_RE = {0, 0, 0.5};
  r.cam0->calibration.T_RC = Pose();
  Calibration c;
  c.poses["cam0.T_RC"] = Pose();
  c.covariance = Eigen::MatrixXd::Zero(6, 6);
  c.covariance.diagonal() << 1e-6, 1e-6, 1e-6, 4e-6, 4e-6, 4e-6;
  Apply(c, r);
  EXPECT_NEAR(r.vision0->registration_noise_rad, 1e-3, 1e-12);
  // Half a metre away the turn about two of three axes moves the tip by 0.5 mm.
  EXPECT_NEAR(r.vision0->registration_noise_m, std::sqrt(4e-6 + 2.0 / 3 * 0.25e-6), 1e-12);
  // Turn and shift that cancel at the tips leave them well known: p = -w x c.
  Eigen::Matrix<double, 6, 3> root;
  root << 1e-3 * Eigen::Matrix3d::Identity(), 1e-3 * Skew({0, 0, 0.5});
  c.covariance = root * root.transpose();
  Apply(c, r);
  EXPECT_NEAR(r.vision0->registration_noise_m, 0, 1e-12);
}

TEST(CalibrationApply, APoseThatWasUnknownIsKnownThen) {
  Recording r = Plain();
  r.vision0.reset();
  r.cam0->has_T_RC = r.cam1->has_T_RC = false;
  r.cam0->calibration.T_RC = r.cam1->calibration.T_RC = Pose();
  Calibration hand_eye;
  hand_eye.poses["cam0.T_RC"] = kPose;
  Apply(hand_eye, r);
  EXPECT_TRUE(r.cam0->has_T_RC);
  EXPECT_FALSE(r.cam1->has_T_RC);  // nobody said how it sits beside cam0
  Calibration stereo;
  stereo.poses["cam1.T_C0C1"] = kPose;
  Apply(stereo, r);
  EXPECT_TRUE(r.cam1->has_T_RC);
  EXPECT_TRUE(r.cam1->calibration.T_RC.Matrix().isApprox((kPose * kPose).Matrix()));
}

TEST(CalibrationApply, WhatHangsOnAnUnknownPoseIsRefused) {
  Recording r = Plain();
  r.cam0->has_T_RC = false;
  Calibration stereo;
  stereo.poses["cam1.T_C0C1"] = kPose;
  EXPECT_THAT(ErrorOf(stereo, r), HasSubstr("where cam0 is in R is unknown"));
  Calibration hand_eye;
  hand_eye.poses["cam0.T_RC"] = kPose;
  EXPECT_THAT(ErrorOf(hand_eye, r), HasSubstr("seen by a camera of unknown pose"));
}

TEST(CalibrationApply, FramesAndTheirTipsMoveInTime) {
  const Recording before = Plain();
  Recording r = before;
  Apply(WithNumbers("cam0.time_offset_s", {-0.0125}), r);
  const auto moved = [](const auto& was, const auto& is) {
    for (std::size_t i = 0; i < was.size(); ++i) EXPECT_EQ(is[i].t_ns - was[i].t_ns, -12'500'000);
    return was.size();
  };
  EXPECT_GT(moved(before.cam0->filenames, r.cam0->filenames) +
                moved(before.cam0->frame_numbers, r.cam0->frame_numbers),
            0);
  EXPECT_GT(moved(before.cam1->filenames, r.cam1->filenames) +
                moved(before.cam1->frame_numbers, r.cam1->frame_numbers),
            0);
  moved(before.vision0->tips, r.vision0->tips);
  EXPECT_EQ(r.wrist0->samples[0].t_ns, before.wrist0->samples[0].t_ns);
  r = before;
  r.cam0.reset();  // tips alone, as live or of another program
  r.cam1.reset();
  Apply(WithNumbers("cam0.time_offset_s", {-0.0125}), r);
  moved(before.vision0->tips, r.vision0->tips);
  r = before;
  r.cam0->filenames.clear();
  r.cam0->frame_numbers.clear();
  r.vision0.reset();
  EXPECT_THAT(ErrorOf(WithNumbers("cam0.time_offset_s", {0.1}), r), HasSubstr("no frames"));
}

TEST(CalibrationApply, AStreamTakesItsClock) {
  const Recording before = Plain();
  Recording r = before;
  const TimeNs origin_ns = before.em0->samples.front().t_ns;
  Calibration c;
  c.numbers["em0.time_offset_s"] = {1.5};
  c.numbers["em0.time_rate"] = {0.001};
  c.numbers["em0.time_origin_s"] = {1e-9 * static_cast<double>(origin_ns)};
  Apply(c, r);
  for (std::size_t i = 0; i < r.em0->samples.size(); ++i) {
    const double since_ns = static_cast<double>(before.em0->samples[i].t_ns - origin_ns);
    EXPECT_NEAR(static_cast<double>(r.em0->samples[i].t_ns - origin_ns), 1.5e9 + 1.001 * since_ns,
                2.0);
  }
  EXPECT_EQ(r.wrist0->samples[0].t_ns, before.wrist0->samples[0].t_ns);
  c.covariance = Eigen::Vector3d(4e-6, 1.0, 9e-10).asDiagonal();
  r = before;
  Apply(c, r);
  EXPECT_NEAR(r.em0->clock.SdAt(origin_ns), 2e-3, 1e-12);
  EXPECT_NEAR(r.em0->clock.SdAt(origin_ns + 100'000'000'000), std::hypot(2e-3, 3e-3), 1e-9);
  Apply(c, r);  // a second one goes on from the first
  EXPECT_NEAR(r.em0->clock.SdAt(origin_ns), std::sqrt(2.0) * 2e-3, 1e-9);
  c.covariance.resize(0, 0);
  c.numbers.erase("em0.time_origin_s");
  EXPECT_THAT(ErrorOf(c, before), HasSubstr("there is no em0.time_origin_s with it"));
  c.numbers["em0.time_origin_s"] = {0.0};
  c.numbers["em0.time_rate"] = {1.0};
  EXPECT_THAT(ErrorOf(c, before), HasSubstr("em0.time_rate: found 1"));
  EXPECT_THAT(ErrorOf(WithNumbers("truth0.time_offset_s", {1.0}), before),
              HasSubstr("unknown name"));
}

}  // namespace
}  // namespace flextip
