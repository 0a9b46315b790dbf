// Late sensors read at the time they speak of, against the undelayed signal.
#include "diagnosis/samples/retiming.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flextip::diagnosis {
namespace {

constexpr double kPeriod_s = 0.02, kOmega = 2.0 * std::numbers::pi * 0.5, kAmplitude_m = 0.05;

/// Sines of 0.5 Hz, the same amplitude on each axis.
Eigen::Vector3d Signal(double t_s) {
  return kAmplitude_m * Eigen::Vector3d(std::sin(kOmega * t_s), std::sin(kOmega * t_s + 1.0),
                                        std::sin(kOmega * t_s + 2.0));
}
/// Turning once in 2 s.
Eigen::Vector3d Direction(double t_s) {
  return {std::cos(kOmega * t_s), std::sin(kOmega * t_s), 0.0};
}

/// 3 s at 50 Hz: the EM sensor in every sample, the tip in every second; both say what was
/// `late_s` before their stamp, which differs from the sample's time by `stamped_s`.
SampleSet Late(double late_s, double stamped_s = 0.0) {
  SampleSet set;
  set.period_s = kPeriod_s;
  set.noise.em_position_m = 1e-4;
  for (int k = 0; k < 150; ++k) {
    DiagnosisSample sample;
    sample.t_s = k * kPeriod_s;
    sample.dt_em_s = sample.dt_tip_s = sample.dt_strain_s = stamped_s;
    const double spoken_of = sample.t_s + stamped_s - late_s;
    for (int r = row::kEmPosition; r < row::kTipPosition; ++r) {
      sample.present.set(r);
      sample.spoken.set(r);
    }
    sample.p_RS = Signal(spoken_of);
    sample.d_em = Direction(spoken_of);
    sample.moments_Nm.head<3>() = Signal(sample.t_s + stamped_s);
    if (k % 2 == 0) {
      for (int r = row::kTipPosition; r < row::kPortDirection; ++r) {
        sample.present.set(r);
        sample.spoken.set(r);
      }
      sample.p_RE = Signal(spoken_of);
      sample.d_tip = Direction(spoken_of);
    }
    set.samples.push_back(sample);
  }
  return set;
}

class Delays : public testing::TestWithParam<double> {};

/// Each value is one that was measured, of the time that it is said to be of, and none is nearer.
TEST_P(Delays, AreTakenOffAt50And25Hz) {
  const double late_s = GetParam();
  const SampleSet set = Late(late_s);
  const Retiming retiming(set);
  for (std::size_t k = 10; k < 140; ++k) {
    const DiagnosisSample at = retiming.At(k, late_s, late_s);
    const double em_s = at.t_s + at.dt_em_s - late_s, tip_s = at.t_s + at.dt_tip_s - late_s;
    EXPECT_LT((at.p_RS - Signal(em_s)).norm(), 1e-12) << k;
    EXPECT_LT((at.d_em - Direction(em_s)).norm(), 1e-12) << k;
    EXPECT_LE(std::abs(at.dt_em_s - late_s), 0.5 * kPeriod_s + 1e-12) << k;
    EXPECT_EQ(at.moments_Nm, set.samples[k].moments_Nm);  // gages are not late
    if (!set.samples[k].Has(row::kTipPosition)) continue;
    EXPECT_LT((at.p_RE - Signal(tip_s)).norm(), 1e-12) << k;
    EXPECT_LT((at.d_tip - Direction(tip_s)).norm(), 1e-12) << k;
    EXPECT_LE(std::abs(at.dt_tip_s - late_s), kPeriod_s + 1e-12) << k;
  }
}
INSTANTIATE_TEST_SUITE_P(Seconds, Delays,
                         testing::Values(-0.03, 0.0, 0.007, 0.02, 0.045, 0.046, 0.072, 0.13));

TEST(Retiming, StampsBesideTheSamplesStayAsTheyAre) {
  const SampleSet set = Late(0.0, 0.006);
  const Retiming retiming(set);
  for (std::size_t k = 10; k < 140; ++k) {
    const DiagnosisSample at = retiming.At(k, 0.0, 0.0);
    EXPECT_EQ(at.p_RS, set.samples[k].p_RS);
    EXPECT_EQ(at.moments_Nm, set.samples[k].moments_Nm);
    EXPECT_NEAR(at.dt_em_s, 0.006, 1e-12);
    EXPECT_NEAR(at.dt_strain_s, 0.006, 1e-12);
  }
}

/// What is not judged still tells late sensors' values.
TEST(Retiming, ReadsBeyondWhatIsJudged) {
  SampleSet set = Late(0.1);
  for (std::size_t k = 130; k < 150; ++k) set.samples[k].present.reset();
  const DiagnosisSample at = Retiming(set).At(128, 0.1, 0.1);
  EXPECT_LT((at.p_RS - Signal(at.t_s + at.dt_em_s - 0.1)).norm(), 1e-12);
  EXPECT_NEAR(at.dt_em_s, 0.1, 1e-9);
}

TEST(Retiming, BesideAGapItsOwnValueStays) {
  SampleSet set = Late(0.0);
  for (std::size_t k = 50; k < 70; ++k)
    for (int r = row::kEmPosition; r < row::kStrain; ++r) set.samples[k].spoken.reset(r);
  const DiagnosisSample at = Retiming(set).At(49, 0.1, 0.0);
  EXPECT_EQ(at.p_RS, set.samples[49].p_RS);
  EXPECT_EQ(at.dt_em_s, 0.1);  // and no rate is trusted that far
}

TEST(Retiming, SamplesThatDoNotResolveTheMotionAreLeftAlone) {
  SampleSet set = Late(0.03);
  set.resolved_in_time = false;
  const Retiming retiming(set);
  EXPECT_EQ(retiming.At(60, 0.03, 0.03).p_RS, set.samples[60].p_RS);
  EXPECT_EQ(retiming.At(60, 0.03, 0.03).p_RE, set.samples[60].p_RE);
}

}  // namespace
}  // namespace flextip::diagnosis
