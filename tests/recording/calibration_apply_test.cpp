// What was found, in the place of what the recording says: each name of docs/formats.md's table;
// the cameras' are in calibration_apply_camera_test.cpp.
#include <gmock/gmock.h>

#include <cmath>

#include "calibration_applied.h"
#include "recording/calibrations/em_field.h"

namespace flextip {
namespace {

using test_support::Apply;
using test_support::ErrorOf;
using test_support::kPose;
using test_support::Plain;
using test_support::WithNumbers;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

TEST(CalibrationApply, TheFieldCorrectsThePlacesOfTheEmSensor) {
  const Recording before = Plain();
  Recording r = before;
  Calibration c = WithNumbers("em0.field", {1e-3, 0, 0, 0, 2e-3, 0, 0, 0, 3e-3});
  EXPECT_THAT(ErrorOf(c, r), HasSubstr("em0.field_centre_m: expected three numbers"));
  c.numbers["em0.field_centre_m"] = {0.1, 0.2, 0.3};
  c.numbers["em0.field_scale_m"] = {0.5, 0.5, 0.5};
  const auto applied = Apply(c, r);
  EXPECT_THAT(applied.used, ElementsAre("em0.field", "em0.field_centre_m", "em0.field_scale_m"));
  const FieldCorrection field{c.numbers["em0.field"], {0.1, 0.2, 0.3}, {0.5, 0.5, 0.5}};
  for (std::size_t i = 0; i < r.em0->samples.size(); ++i) {
    const Eigen::Vector3d p = before.em0->samples[i].value.p_RS;
    EXPECT_EQ(r.em0->samples[i].value.p_RS, ApplyField(field, p));
    EXPECT_NE(r.em0->samples[i].value.p_RS, p);
  }
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
