// Hand-eye calibration of a robot that is known exactly.
#include "calibration/hand_eye/hand_eye.h"

#include <gmock/gmock.h>

#include "calibration/hand_eye/fit.h"
#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "tests/calibration/hand_eye_scene.h"

namespace flextip {
namespace {

using hand_eye_test::EyeInHand;
using hand_eye_test::EyeToHand;
using hand_eye_test::Record;
using hand_eye_test::Scene;
using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr HandEyeOptions kQuick{.hold_out = false};

Eigen::VectorXd ErrorOf(const HandEyeResult& found, const Scene& truth) {
  Eigen::VectorXd e(found.has_time_offset ? 13 : 12);
  e.head<6>() = PoseDifference(found.T_FC, truth.T_FC);
  e.segment<6>(6) = PoseDifference(found.T_KB, truth.T_KB);
  if (found.has_time_offset) e[12] = truth.time_offset_s - found.time_offset_s;
  return e;
}

// Mean over `runs` of the squared error over its covariance and degree of freedom: 1 if honest,
// with a standard deviation of sqrt(2 / (runs n)).
double MeanNees(const Scene& scene, int views, int runs) {
  double sum = 0;
  for (int run = 0; run < runs; ++run) {
    const auto r = CalibrateHandEye(Record(scene, views, 100 + run), kQuick);
    EXPECT_TRUE(r.IsUsable()) << r.message;
    const Eigen::VectorXd e = ErrorOf(r, scene);
    sum += MahalanobisSquared(e, r.covariance) / static_cast<double>(e.size());
  }
  return sum / runs;
}

class HandEyeBothMounts : public testing::TestWithParam<HandEyeMount> {
 protected:
  static Scene Given() {
    return GetParam() == HandEyeMount::kEyeToHand ? EyeToHand() : EyeInHand();
  }
};
INSTANTIATE_TEST_SUITE_P(ToHandAndInHand, HandEyeBothMounts,
                         testing::Values(HandEyeMount::kEyeToHand, HandEyeMount::kEyeInHand));

TEST_P(HandEyeBothMounts, FindsTheTruthWithinWhatItClaims) {
  // 20 runs of 12 numbers: the mean is 1 with a standard deviation of 0.09; the noise is not taken
  // below the stated one, which makes it a little smaller.
  const double nees = MeanNees(Given(), 12, 20);
  EXPECT_GT(nees, 0.65);
  EXPECT_LT(nees, 1.3);
}

TEST_P(HandEyeBothMounts, WithoutNoiseItIsExact) {
  Scene s = Given();
  s.corner_noise_px = s.orientation_noise_rad = s.position_noise_m = 0;
  const auto r = CalibrateHandEye(Record(s, 8, 1), kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_LT(ErrorOf(r, s).norm(), 1e-7);
  EXPECT_LT(r.rms_px, 1e-4);
  EXPECT_EQ(r.views_used, 8);
}

TEST_P(HandEyeBothMounts, TheDerivativesAreThose) {
  const Scene s = Given();
  const Pose T_RW = hand_eye_test::WristOf(s, 1.0);
  std::vector<Correspondence> points;
  for (int i = 0; i < 5; ++i) points.push_back({{0.01 * i, 0.007 * i * i, 0.002 * i}, {600, 500}});
  const auto residuals = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    CameraCalibration lens = s.camera;
    lens.fu_px += x[13];
    lens.fv_px += x[14];
    lens.cu_px += x[15];
    lens.cv_px += x[16];
    return ResidualsOfChain(s.mount, CameraModel(lens), points, MovePose(s.T_FC, x.head<6>()),
                            MovePose(s.T_KB, x.segment<6>(6)), MovePose(T_RW, x.tail<6>()))
        ->r_px;
  };
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(kShared + 6);
  const Eigen::MatrixXd expected = NumericJacobian(residuals, zero, 1e-4);
  const auto found = ResidualsOfChain(s.mount, CameraModel(s.camera), points, s.T_FC, s.T_KB, T_RW);
  EXPECT_LT((found->J - expected.leftCols<kShared>()).norm(), 1e-6 * expected.norm());
  EXPECT_LT((found->J_wrist - expected.rightCols<6>()).norm(), 1e-6 * expected.norm());

  const Pose board = BoardInCamera(s.mount, s.T_FC, s.T_KB, T_RW);
  const auto pose = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return PoseDifference(
        board, BoardInCamera(s.mount, MovePose(s.T_FC, x.head<6>()),
                             MovePose(s.T_KB, x.segment<6>(6)), MovePose(T_RW, x.tail<6>())));
  };
  const Eigen::MatrixXd steps = NumericJacobian(pose, Eigen::VectorXd::Zero(18), 1e-4);
  EXPECT_LT((ChainJacobian(s.mount, s.T_FC, s.T_KB, T_RW) - steps).norm(), 1e-7);
}

TEST_P(HandEyeBothMounts, TheWrongMountIsNoticed) {
  for (const int views : {6, 12}) {
    HandEyeInput input = Record(Given(), views, 4);
    const bool to_hand = input.mount == HandEyeMount::kEyeToHand;
    input.mount = to_hand ? HandEyeMount::kEyeInHand : HandEyeMount::kEyeToHand;
    const auto r = CalibrateHandEye(input, kQuick);
    EXPECT_EQ(r.status, HandEyeStatus::kNotConverged);
    EXPECT_THAT(r.message,
                HasSubstr(to_hand ? "the board is on the wrist" : "the camera is on the wrist"));
  }
}

// Pictures of another day: their wrists have nothing to do with the boards.
TEST(HandEye, WristsOfAnotherRecordingAreRefused) {
  HandEyeInput input = Record(EyeToHand(), 12, 4);
  Scene other = EyeToHand();
  other.board =
      hand_eye_test::Steps(other.frame_period_s, 0.25, 0.5, 99, hand_eye_test::Middle(other));
  input.wrist = Record(other, 12, 5).wrist;
  const auto r = CalibrateHandEye(input, kQuick);
  EXPECT_TRUE(r.status == HandEyeStatus::kNotConverged || (!r.knows_camera && !r.knows_board));
}

TEST(HandEye, FindsTheTimeOffset) {
  Scene s = EyeToHand();
  s.frame_period_s = 0.3137;  // pictures fall between the wrist's samples
  s.board = hand_eye_test::Sweep(s, 0.25, 0.5);
  s.time_offset_s = 0.073;
  const auto r = CalibrateHandEye(Record(s, 15, 3), kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  ASSERT_TRUE(r.has_time_offset);
  EXPECT_LT(std::sqrt(r.covariance(12, 12)), 1e-3);
  const double nees = MeanNees(s, 15, 15);  // 13 numbers with the offset
  EXPECT_GT(nees, 0.65);
  EXPECT_LT(nees, 1.4);
}

TEST(HandEye, TimeOffsetIsRefusedWhereNothingMoves) {
  const auto r = CalibrateHandEye(Record(EyeToHand(), 10, 3), kQuick);
  ASSERT_TRUE(r.IsUsable());
  EXPECT_FALSE(r.has_time_offset);
  EXPECT_THAT(r.unobservable,
              Contains(AllOf(Field(&Calibration::Unobservable::parameter, "time_offset_s"),
                             Field(&Calibration::Unobservable::reason, HasSubstr("stood still")))));
}

TEST(HandEye, BadWristPosesAreFoundAndNamed) {
  const Scene s = EyeToHand();
  HandEyeInput input = Record(s, 14, 5);
  for (const int bad : {3, 9}) {
    const TimeNs t = input.views[bad].t_ns;
    for (auto& sample : input.wrist.samples) {
      if (std::abs(sample.t_ns - t) < 50'000'000) sample.value.p_RW.x() += bad == 3 ? 0.01 : -0.004;
    }
  }
  const auto r = CalibrateHandEye(input, kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_EQ(r.views_rejected, 2);
  for (const int bad : {3, 9}) {
    EXPECT_FALSE(r.views[bad].used);
    EXPECT_THAT(r.views[bad].reason, HasSubstr("away from where the wrist puts it"));
  }
  const Eigen::VectorXd e = ErrorOf(r, s);
  EXPECT_LT(MahalanobisSquared(e, r.covariance), 35.0);  // 12 numbers: 1 in 2000
}

TEST(HandEye, AWristThatIsNoisierThanStatedIsNoticed) {
  HandEyeInput input = Record(EyeToHand(), 25, 6);
  input.wrist.position_noise_m /= 4;
  input.wrist.orientation_noise_rad /= 4;
  const auto r = CalibrateHandEye(input, kQuick);
  ASSERT_TRUE(r.IsUsable());
  EXPECT_NEAR(r.position_noise_scale, 4, 1.5);
  EXPECT_NEAR(r.orientation_noise_scale, 4, 1.5);
}

// Small boards a metre away: the better one of both planar poses is often the wrong one.
TEST(HandEye, FlippedBoardsAreSetRight) {
  Scene s = EyeToHand();
  s.columns = 6;
  s.rows = 4;
  s.square_m = 0.006;
  s.corner_noise_px = 0.3;
  s.board = hand_eye_test::Steps(s.frame_period_s, 1.0, 0.5, 7, hand_eye_test::Middle(s));
  int flipped = 0;
  for (unsigned run = 0; run < 4; ++run) {
    const auto r = CalibrateHandEye(Record(s, 16, run), kQuick);
    ASSERT_TRUE(r.IsUsable()) << r.message;
    EXPECT_LT((r.T_FC.p - s.T_FC.p).norm(), 0.004);
    for (const auto& view : r.views) flipped += view.flipped;
  }
  EXPECT_GE(flipped, 4);
}

// The board turns about the axis of a joint that stands still in F, and shifts along `shift`.
Scene TurningAbout(const Eigen::Vector3d& axis_R, double angle_rad, const Eigen::Vector3d& shift) {
  Scene s = EyeToHand();
  const Pose T_CB = {ExpRotation({0.5, 0.3, 0.1}), {-0.03, -0.02, 0.25}};
  const Pose T_RW0 = s.T_FC * T_CB * s.T_KB.Inverse();
  const double period_s = s.frame_period_s;
  s.board = [=](double t) {
    const double k = std::floor(t / period_s + 0.5);
    const Pose T_RW = {ExpRotation(angle_rad * std::sin(1.3 * k) * axis_R) * T_RW0.R,
                       T_RW0.p + std::sin(2.1 * k + 1) * shift};
    return s.T_FC.Inverse() * T_RW * s.T_KB;
  };
  return s;
}

// About the camera's axis: turning the board in the picture tells nothing new, tilting it does.
TEST(HandEye, OneAxisIsRefused) {
  const Eigen::Vector3d axis = EyeToHand().T_FC.R.col(2);
  const auto r = CalibrateHandEye(Record(TurningAbout(axis, 0.5, {0, 0, 0}), 14, 8), kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_FALSE(r.knows_camera);
  EXPECT_THAT(r.unobservable,
              Contains(Field(&Calibration::Unobservable::reason, HasSubstr("one axis only"))));
  const Calibration c = HandEyeCalibration(r);
  EXPECT_EQ(c.poses.count("cam0.T_RC"), 0u);
  EXPECT_THAT(c.unobservable,
              Contains(Field(&Calibration::Unobservable::parameter, HasSubstr("cam0.T_RC.p["))));
  ASSERT_FALSE(r.motions.empty());
  EXPECT_LT(r.motions.front().sd_after_m, 0.2 * r.motions.front().sd_before_m);
  EXPECT_THAT(r.motions.front().words, HasSubstr("tilt"));
}

TEST(HandEye, PlanarMotionLeavesTheShiftAlongTheAxisOpen) {
  const auto r =
      CalibrateHandEye(Record(TurningAbout({0, 0, 1}, 0.4, {0.02, -0.015, 0}), 14, 8), kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_FALSE(r.knows_camera);
  EXPECT_THAT(r.unobservable,
              Contains(Field(&Calibration::Unobservable::parameter, "camera.p[2]")));
  // Its orientation is known: the shifts show it.
  EXPECT_THAT(r.unobservable,
              Not(Contains(Field(&Calibration::Unobservable::parameter, HasSubstr("camera.w")))));
}

TEST(HandEye, ShiftsAloneTellNoPlace) {
  Scene s = TurningAbout({0, 0, 1}, 0.0, {0.02, 0.01, 0});
  const auto still = s.board;
  s.board = [=](double t) {
    Pose T = still(t);
    T.p.z() += 0.02 * std::cos(1.7 * std::floor(t / s.frame_period_s + 0.5));
    return T;
  };
  const auto r = CalibrateHandEye(Record(s, 14, 8), kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_FALSE(r.knows_camera);
  EXPECT_FALSE(r.knows_board);
  EXPECT_THAT(r.unobservable,
              Contains(Field(&Calibration::Unobservable::reason, HasSubstr("did not turn"))));
}

TEST(HandEye, AllIsKnownWhereTheWristTurnedAboutAll) {
  const auto r = CalibrateHandEye(Record(EyeToHand(), 10, 2));
  ASSERT_TRUE(r.IsUsable());
  EXPECT_TRUE(r.knows_camera && r.knows_board);
  EXPECT_GT(r.held_out_px, r.rms_px);  // in sample it is always better
  const Calibration c = HandEyeCalibration(r);
  EXPECT_EQ(c.CoordinateNames().size(), 12u);
  // board.T_WB comes before cam0.T_RC.
  EXPECT_TRUE(c.CovarianceOf("cam0.T_RC").isApprox(r.covariance.topLeftCorner(6, 6)));
  EXPECT_TRUE(c.CovarianceOf("board.T_WB").isApprox(r.covariance.bottomRightCorner(6, 6)));
}

// Three faces of a collar, four corners each: not flat, and no four corners alone are enough.
TEST(HandEye, ACollarOfTagsIsATargetToo) {
  const Scene s = EyeToHand();
  HandEyeInput input = Record(s, 12, 4);
  const CameraModel model(s.camera);
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.1);
  for (HandEyeView& view : input.views) {
    const Pose T_CB = s.board(1e-9 * static_cast<double>(view.t_ns));
    view.sighting = {};
    for (int face = 0; face < 3; ++face) {
      const Pose T_BG = {ExpRotation({0, 0.8 * (face - 1), 0}),
                         {0.03 * face, 0.02, 0.012 * (face != 1)}};
      for (const auto& [x, y] : {std::pair(-1, 1), {1, 1}, {1, -1}, {-1, -1}}) {
        view.sighting.x_B.push_back(T_BG * Eigen::Vector3d(0.012 * x, 0.012 * y, 0));
        view.sighting.px.push_back(model.Project(T_CB * view.sighting.x_B.back()).value() +
                                   DrawVector<2>(noise, random));
      }
    }
  }
  const auto r = CalibrateHandEye(input, kQuick);
  ASSERT_TRUE(r.IsUsable()) << r.message;
  EXPECT_EQ(r.views_used, 12);
  const Eigen::VectorXd e = ErrorOf(r, s);
  EXPECT_LT(MahalanobisSquared(e, r.covariance), 35.0);  // 12 numbers: 1 in 2000
  EXPECT_EQ(HandEyeCalibration(r, "tags0").poses.count("tags0.T_WE"), 1u);
}

TEST(HandEye, TooFewViewsIsAStatusWithReasons) {
  HandEyeInput input = Record(EyeToHand(), 4, 2);
  input.views[1].sighting = {{}, {}, {}, "no chessboard"};
  input.views[2].t_ns += 1'000'000'000'000;
  const auto r = CalibrateHandEye(input, kQuick);
  EXPECT_EQ(r.status, HandEyeStatus::kTooFewViews);
  EXPECT_EQ(r.views[1].reason, "no chessboard");
  EXPECT_THAT(r.views[2].reason, HasSubstr("wrist"));
  input.wrist.samples.clear();
  EXPECT_THROW(CalibrateHandEye(input, kQuick), InputError);
}

}  // namespace
}  // namespace flextip
