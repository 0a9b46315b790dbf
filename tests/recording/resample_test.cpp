#include "recording/resample.h"

#include <gmock/gmock.h>

#include <random>

#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kRate_hz = 50.0;
constexpr TimeNs kPeriod = 20'000'000;
constexpr TimeNs kStart = 1'700'000'000'000'000'000;

double Seconds(TimeNs t_ns) { return 1e-9 * static_cast<double>(t_ns - kStart); }

/// A cubic in time, far from linear between samples.
Eigen::Vector3d Position(TimeNs t_ns) {
  const double t = Seconds(t_ns);
  return {0.3 + 2 * t - 5 * t * t, -t * t * t, 1 + t};
}
constexpr double kMaxSecondDerivative = 12.3;  // |(-10, -6 t, 0)| for t up to 1.18 s, 60 samples

/// Constant rate about a fixed axis: slerp is exact for it.
Eigen::Quaterniond Rotation(TimeNs t_ns) {
  const Eigen::Vector3d w = Eigen::Vector3d(0.3, -0.8, 0.52).normalized() * 2.5;
  return Eigen::Quaterniond(ExpRotation(w * Seconds(t_ns)));
}

template <class F>
auto Sampled(int count, F value) {
  Series<decltype(value(TimeNs{}))> series;
  for (int i = 0; i < count; ++i)
    series.push_back({kStart + i * kPeriod, value(kStart + i * kPeriod)});
  return series;
}

EmStream MakeEm() {
  EmStream em;
  em.rate_hz = kRate_hz;
  em.samples = Sampled(60, [](TimeNs t) {
    // q and -q are the same rotation; a sensor may flip between them.
    Eigen::Quaterniond q = Rotation(t);
    if ((t / kPeriod) % 3 == 0) q.coeffs() *= -1.0;
    return EmSample{Position(t), q};
  });
  return em;
}

std::vector<TimeNs> RandomTimes(TimeNs last) {
  std::mt19937_64 generator(11);
  std::uniform_int_distribution<TimeNs> uniform(kStart, last);
  std::vector<TimeNs> times(500);
  for (auto& t : times) t = uniform(generator);
  return times;
}

TEST(Resample, StraightLinesAndConstantRotationRatesAreExact) {
  EmStream em = MakeEm();
  for (auto& sample : em.samples) {
    sample.value.p_RS = Eigen::Vector3d(1, -2, 3) * Seconds(sample.t_ns);
  }
  for (const TimeNs t : RandomTimes(em.samples.back().t_ns)) {
    const auto at = EmAt(em, t);
    ASSERT_TRUE(at.has_value());
    EXPECT_LT((at->p_RS - Eigen::Vector3d(1, -2, 3) * Seconds(t)).norm(), 1e-14);
    EXPECT_LT(at->q_RS.angularDistance(Rotation(t)), 1e-7);  // acos near 1 keeps half the digits
    EXPECT_NEAR(at->q_RS.norm(), 1.0, 1e-14);
  }
}

TEST(Resample, CurvesAreWithinTheBoundOfLinearInterpolation) {
  const EmStream em = MakeEm();
  const double h = 1.0 / kRate_hz;
  double worst = 0.0;
  for (const TimeNs t : RandomTimes(em.samples.back().t_ns)) {
    worst = std::max(worst, (EmAt(em, t)->p_RS - Position(t)).norm());
  }
  EXPECT_LT(worst, kMaxSecondDerivative * h * h / 8);  // |x''| h^2 / 8
  EXPECT_GT(worst, 10.0 * h * h / 8 * 0.9);            // and it is the curve that was looked up
}

TEST(Resample, SamplesComeBackBitForBit) {
  const EmStream em = MakeEm();
  for (const auto& sample : em.samples) {
    const auto at = EmAt(em, sample.t_ns);
    ASSERT_TRUE(at.has_value());
    EXPECT_EQ(at->p_RS, sample.value.p_RS);
    EXPECT_EQ(at->q_RS.coeffs(), sample.value.q_RS.coeffs());
  }
}

TEST(Resample, NothingOutsideNorAcrossALongGap) {
  EmStream em = MakeEm();
  EXPECT_FALSE(EmAt(em, em.samples.front().t_ns - 1));
  EXPECT_FALSE(EmAt(em, em.samples.back().t_ns + 1));
  EXPECT_FALSE(EmAt(EmStream{}, kStart));
  const TimeNs before = em.samples[9].t_ns;
  em.samples.erase(em.samples.begin() + 10, em.samples.begin() + 12);  // three periods: bridged
  EXPECT_TRUE(EmAt(em, before + kPeriod));
  em.samples.erase(em.samples.begin() + 10);  // four periods: not
  EXPECT_FALSE(EmAt(em, before + 1));
  EXPECT_FALSE(EmAt(em, before + 4 * kPeriod - 1));
  EXPECT_TRUE(EmAt(em, before));
  EXPECT_TRUE(EmAt(em, before + 4 * kPeriod));
  EXPECT_TRUE(EmAt(em, before + 1, {.max_gap_periods = 4.5}));
}

TEST(Resample, WristHasAnOrientationWhereBothNeighboursDo) {
  WristStream wrist;
  wrist.rate_hz = kRate_hz;
  wrist.samples = Sampled(5, [](TimeNs t) { return WristSample{Position(t), Rotation(t)}; });
  wrist.samples[3].value.q_RW.reset();
  const TimeNs half = kPeriod / 2;
  const auto both = WristAt(wrist, kStart + half);
  ASSERT_TRUE(both && both->q_RW);
  EXPECT_LT(both->q_RW->angularDistance(Rotation(kStart + half)), 1e-7);
  EXPECT_TRUE(WristAt(wrist, kStart + 2 * kPeriod)->q_RW);
  EXPECT_FALSE(WristAt(wrist, kStart + 2 * kPeriod + half)->q_RW);
  EXPECT_FALSE(WristAt(wrist, kStart + 3 * kPeriod)->q_RW);
}

TEST(Resample, StrainAndLoad) {
  StrainStream strain;
  strain.rate_hz = kRate_hz;
  strain.moments_Nm = Sampled(
      4, [](TimeNs t) { return Eigen::Vector4d(Eigen::Vector4d(1, 2, -3, 4) * Seconds(t)); });
  LoadStream load;
  load.rate_hz = kRate_hz;
  load.f_tip_N = Sampled(4, [](TimeNs t) { return Eigen::Vector3d(0, 1 - Seconds(t), 7); });
  const TimeNs t = kStart + kPeriod + kPeriod / 4;
  EXPECT_LT((*StrainAt(strain, t) - Eigen::Vector4d(1, 2, -3, 4) * 0.025).norm(), 1e-15);
  EXPECT_LT((*LoadAt(load, t) - Eigen::Vector3d(0, 0.975, 7)).norm(), 1e-15);
}

TEST(Resample, TipIsTheNearestFrameWithinHalfAPeriod) {
  VisionStream vision;
  vision.rate_hz = kRate_hz;
  for (const int i : {0, 1, 4}) {
    TipObservation tip;
    tip.p_RE.x() = i;
    vision.tips.push_back({kStart + i * kPeriod, tip});
  }
  const auto index = [&](TimeNs t) {
    const auto tip = TipAt(vision, t);
    return tip ? static_cast<int>(tip->value.p_RE.x()) : -1;
  };
  EXPECT_EQ(index(kStart), 0);
  EXPECT_EQ(index(kStart + kPeriod / 2 - 1), 0);
  EXPECT_EQ(index(kStart + kPeriod / 2 + 1), 1);
  EXPECT_EQ(index(kStart + 3 * kPeriod / 2 + 1), -1);
  EXPECT_EQ(index(kStart + 7 * kPeriod / 2 - 1), -1);
  EXPECT_EQ(index(kStart + 4 * kPeriod + kPeriod / 2), 4);
  EXPECT_EQ(index(kStart + 4 * kPeriod + kPeriod / 2 + 1), -1);
  EXPECT_EQ(index(kStart - kPeriod / 2 - 1), -1);
  EXPECT_EQ(TipAt(vision, kStart + 1)->t_ns, kStart);
  EXPECT_FALSE(TipAt(VisionStream{}, kStart));
}

TEST(Resample, TimesAreThoseOfTheSamples) {
  const Series<int> series{{1, 7}, {2, 8}};
  EXPECT_EQ(TimesOf(series), (std::vector<TimeNs>{1, 2}));
}

}  // namespace
}  // namespace flextip
