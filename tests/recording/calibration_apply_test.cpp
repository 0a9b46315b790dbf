// What was found, in the place of what the recording says: each name of docs/formats.md's table.
#include "recording/calibration_apply.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "core/rotation.h"
#include "sample_recording.h"

namespace flextip {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MakeRecording;

AppliedCalibration Apply(const Calibration& c, Recording& recording) {
  return ApplyCalibration("found.yaml", c, recording);
}
Calibration WithNumbers(const std::string& name, const std::vector<double>& values) {
  Calibration c;
  c.numbers[name] = values;
  return c;
}
std::string ErrorOf(const Calibration& c, Recording recording) {
  try {
    Apply(c, recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
const Pose kPose{ExpRotation({0.3, -1.2, 0.4}), {0.1, -0.05, 0.2}};

/// A recording with numbers of a size that survives arithmetic.
Recording Plain() {
  Recording r = MakeRecording();
  r.instrument.length_m = 0.6;
  r.cam0->calibration.T_RC = {ExpRotation({0.1, 0.2, -0.3}), {0.3, 0.1, -0.2}};
  r.cam1->calibration.T_RC = {ExpRotation({0.1, 0.2, -0.3}), {0.31, 0.1, -0.2}};
  r.vision0->camera = "cam0";
  int i = 0;
  for (auto& sample : r.vision0->tips) {
    const double x = 0.01 * ++i;
    sample.value = {TipStatus::kOk,
                    {0.2 + x, x * x, -x},
                    Eigen::Vector3d(1, 4, 9).asDiagonal(),
                    Eigen::Vector3d::UnitX()};
  }
  i = 0;
  for (auto& sample : r.em0->samples) {
    const double x = 0.01 * ++i;
    sample.value = {{0.1 + x, x, -x}, Eigen::Quaterniond(ExpRotation({x, 0.2, 0.1}))};
  }
  i = 0;
  for (auto& sample : r.strain0->moments_Nm) {
    ++i;
    sample.value << i, 2 + i, 3 - i, i * i;
  }
  return r;
}

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
  const testing::TemporaryFolder folder;
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
  r.cam0->filenames.clear();
  r.cam0->frame_numbers.clear();
  r.vision0.reset();
  EXPECT_THAT(ErrorOf(WithNumbers("cam0.time_offset_s", {0.1}), r), HasSubstr("no frames"));
}

TEST(CalibrationApply, TheTipIsWhereItWasFoundOnTheCollar) {
  const Recording before = Plain();
  Recording r = before;
  Apply(WithNumbers("tags0.p_E", {0.001, -0.002, 0.003}), r);
  for (std::size_t i = 0; i < r.tags0->tags.size(); ++i) {
    const Pose& was = before.tags0->tags[i].T_EG;
    const Pose& is = r.tags0->tags[i].T_EG;
    // The point found is the new frame's origin, seen from every tag.
    EXPECT_TRUE((is.Inverse() * Eigen::Vector3d::Zero().eval())
                    .isApprox(was.Inverse() * Eigen::Vector3d(0.001, -0.002, 0.003)));
    EXPECT_EQ(is.R, was.R);
  }
}

TEST(CalibrationApply, TheTipGivesTheLength) {
  Recording r = Plain();
  Apply(WithNumbers("tip.p_WE", {0.58, 0.003, 0.004}), r);
  EXPECT_DOUBLE_EQ(r.instrument.length_m, std::hypot(0.58, 0.005));
  EXPECT_THAT(ErrorOf(WithNumbers("tip.p_WE", {0.5, 0.5, 0}), r), HasSubstr("45.0 deg off"));
  EXPECT_THAT(ErrorOf(WithNumbers("tip.p_WE", {-0.5, 0, 0}), r), HasSubstr("180.0 deg off"));
}

TEST(CalibrationApply, EmSamplesAreTurnedIntoTheRobotsFrame) {
  const Recording before = Plain();
  Recording r = before;
  Calibration c;
  c.poses["em0.T_RF"] = kPose;
  c.covariance = 1e-6 * Eigen::MatrixXd::Identity(6, 6);
  c.numbers["em0.distance_from_tip_m"] = {0.0173};
  c.covariance.conservativeResize(7, 7);
  c.covariance.row(6).setZero();
  c.covariance.col(6).setZero();
  Apply(c, r);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < r.em0->samples.size(); ++i) {
    const EmSample& was = before.em0->samples[i].value;
    const EmSample& is = r.em0->samples[i].value;
    const Pose expected = kPose * Pose::FromQuaternion(was.q_RS, was.p_RS);
    EXPECT_TRUE(is.p_RS.isApprox(expected.p));
    EXPECT_TRUE(is.q_RS.toRotationMatrix().isApprox(expected.R));
    centre += is.p_RS / static_cast<double>(r.em0->samples.size());
  }
  EXPECT_EQ(r.em0->distance_from_tip_m, 0.0173);
  EXPECT_NEAR(r.em0->registration_noise_rad, 1e-3, 1e-9);
  const double lever = (centre - kPose.p).norm();
  EXPECT_NEAR(r.em0->registration_noise_m, 1e-3 * std::sqrt(1 + 2.0 / 3 * lever * lever), 1e-9);
  EXPECT_THAT(ErrorOf(WithNumbers("em0.distance_from_tip_m", {0.7}), r), HasSubstr("0.7"));
}

TEST(CalibrationApply, TheFieldIsLeftToItsOwner) {
  Recording r = Plain();
  Calibration c = WithNumbers("em0.field", {1, 2, 3});
  c.numbers["em0.field_centre_m"] = {0, 0, 0};
  const auto applied = Apply(c, r);
  EXPECT_THAT(applied.em_field, ElementsAre("em0.field", "em0.field_centre_m"));
  EXPECT_TRUE(applied.used.empty());
}

TEST(CalibrationApply, ReadingsBecomeMoments) {
  const Recording before = Plain();
  Recording r = before;
  r.strain0->moment_noise_Nm = 0.5;
  Calibration c =
      WithNumbers("strain0.gage_matrix", {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 4, 0, 0, 4});
  c.numbers["strain0.offset_Nm"] = {10, 20, 30, 40};
  Apply(c, r);
  for (std::size_t i = 0; i < r.strain0->moments_Nm.size(); ++i) {
    const Eigen::Vector4d was = before.strain0->moments_Nm[i].value;
    const Eigen::Vector4d expected(was[0] - 10, 2 * (was[1] - 20), 3 * (was[2] - 30),
                                   4 * (was[0] - 10) + 4 * (was[3] - 40));
    EXPECT_TRUE(r.strain0->moments_Nm[i].value.isApprox(expected));
  }
  EXPECT_NEAR(r.strain0->moment_noise_Nm, 0.5 * std::sqrt((1 + 4 + 9 + 16 + 16) / 4.0), 1e-12);
  c.numbers["strain0.moment_noise_Nm"] = {0.25};
  Apply(c, r);
  EXPECT_EQ(r.strain0->moment_noise_Nm, 0.25);
  c.numbers.erase("strain0.offset_Nm");
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("there is no strain0.offset_Nm"));
}

TEST(CalibrationApply, SetsTheStiffness) {
  Recording r = Plain();
  Calibration c = WithNumbers("instrument.bending_stiffness_Nm2", {0.123});
  c.numbers["instrument.stiffness_taper"] = {-0.1};
  Apply(c, r);
  EXPECT_EQ(r.instrument.bending_stiffness_Nm2, 0.123);
  EXPECT_EQ(r.instrument.stiffness_taper, -0.1);
  c.numbers["instrument.stiffness_taper"] = {2.0};
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("instrument.stiffness_taper: found 2"));
  EXPECT_THAT(ErrorOf(WithNumbers("instrument.bending_stiffness_Nm2", {0}), r),
              HasSubstr("found 0"));
}

TEST(CalibrationApply, TheSetUpIsNoPartOfTheRecording) {
  Recording r = Plain();
  Calibration c = WithNumbers("pivot.p_R", {1, 2, 3});
  c.poses["board.T_WB"] = kPose;
  c.poses["board.T_RB"] = kPose;
  c.poses["tags0.T_WE"] = kPose;
  c.numbers["tip.p_SE"] = {0.1, 0, 0};
  const auto applied = Apply(c, r);
  EXPECT_TRUE(applied.used.empty());
  EXPECT_THAT(applied.not_used,
              ElementsAre("board.T_RB", "board.T_WB", "tags0.T_WE", "pivot.p_R", "tip.p_SE"));
}

TEST(CalibrationApply, RefusesWhatItDoesNotKnowAndWhatIsNotThere) {
  const Recording r = Plain();
  EXPECT_THAT(ErrorOf(WithNumbers("cam0.magic", {1}), r),
              HasSubstr("found.yaml: cam0.magic: unknown"));
  Calibration on_wrist;
  on_wrist.poses["cam0.T_WC"] = kPose;
  EXPECT_THAT(ErrorOf(on_wrist, r), HasSubstr("moves with the wrist"));
  Calibration other;
  other.poses["cam0.T_XY"] = kPose;
  EXPECT_THAT(ErrorOf(other, r), HasSubstr("unknown name"));
  EXPECT_THAT(ErrorOf(WithNumbers("cam0.intrinsics", {1, 2}), r), HasSubstr("found 2 numbers"));

  Calibration stereo;
  stereo.poses["cam1.T_C0C1"] = kPose;
  stereo.poses["cam1.T_RC"] = kPose;
  EXPECT_THAT(ErrorOf(stereo, r), HasSubstr("cam1.T_C0C1: the file has cam1.T_RC too"));
  stereo.poses.erase("cam1.T_RC");
  Recording mono = r;
  mono.cam1.reset();
  EXPECT_THAT(ErrorOf(stereo, mono), HasSubstr("cam1.T_C0C1: the recording has no cam1"));
  mono.cam1 = r.cam1;
  mono.cam0.reset();
  EXPECT_THAT(ErrorOf(stereo, mono), HasSubstr("cam1.T_C0C1: the recording has no cam0"));

  const Recording empty;
  for (const char* name : {"cam1.intrinsics", "cam0.time_offset_s", "tags0.p_E",
                           "em0.distance_from_tip_m", "em0.field"}) {
    const std::size_t count = std::string(name) == "cam1.intrinsics" ? 4
                              : std::string(name) == "tags0.p_E"     ? 3
                                                                     : 1;
    const std::string sensor = std::string(name).substr(0, std::string(name).find('.'));
    EXPECT_THAT(ErrorOf(WithNumbers(name, std::vector<double>(count, 1.0)), empty),
                HasSubstr(std::string(name) + ": the recording has no " + sensor));
  }
}

}  // namespace
}  // namespace flextip
