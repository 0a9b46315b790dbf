// Each fault of a sensor does what it says: samples with it beside the same without it.
#include "simulation/faults/sensor_faults.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "simulation/sensors/sensors.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kRate_hz = 100.0, kStart_s = 0.2, kLasts_s = 0.3;
constexpr int kCycles = 80;

TimeNs TimeOf(double t_s) { return kSimulationStart_ns + std::llround(1e9 * t_s); }

/// Readings of a cycle whose figures tell its number.
SensorReadings Clean(int cycle) {
  const TimeNs t_ns = TimeOf(cycle / kRate_hz);
  const Vector3d p(0.1 + 1e-3 * cycle, 0.2, 0.3);
  SensorReadings readings;
  readings.wrist = {t_ns, {p, {}, 1e-5, 0.0}};
  readings.tip = {t_ns, {{TipStatus::kOk, p, Eigen::Matrix3d::Identity(), Vector3d::UnitX()}, 0.0}};
  readings.em0 = {t_ns, {{Eigen::Matrix3d::Identity(), p}, 0.02, 1e-4, 1e-4}};
  readings.strain = {t_ns, {{1.0 + cycle, 2.0, 3.0, 4.0}, {0.1, 0.2}, 1e-3}};
  readings.load = {t_ns, {p, 0.1}};
  return readings;
}

/// All cycles' readings under the faults.
std::vector<SensorReadings> CyclesOf(const std::vector<Fault>& faults, std::uint64_t seed = 1) {
  SensorFaults injected(faults, seed);
  std::vector<SensorReadings> cycles;
  for (int i = 0; i < kCycles; ++i) {
    cycles.push_back(Clean(i));
    injected.Disturb(TimeOf(i / kRate_hz), cycles.back());
  }
  return cycles;
}

std::vector<SensorReadings> CyclesOf(FaultKind kind, FaultStream stream, double size) {
  return CyclesOf({Fault{kind, stream, kStart_s, kLasts_s, size}});
}

bool IsIn(int cycle) {
  return Fault{.start_s = kStart_s, .duration_s = kLasts_s}.IsActive(cycle / kRate_hz);
}

Vector3d TipOff(const std::vector<SensorReadings>& cycles, int i) {
  const auto at = static_cast<std::size_t>(i);
  return cycles[at].tip->value.tip.p_RE - Clean(i).tip->value.tip.p_RE;
}

/// How many cycles older the tip's figures are than its cycle.
int Age(const std::vector<SensorReadings>& cycles, int i) {
  return -static_cast<int>(std::lround(1e3 * TipOff(cycles, i).x()));
}

TEST(SensorFaults, WithoutOneNothingChanges) {
  const auto cycles = CyclesOf({});
  for (int i = 0; i < kCycles; ++i) EXPECT_EQ(TipOff(cycles, i), Vector3d::Zero());
}

TEST(SensorFaults, AStuckTipKeepsItsFiguresUnderNewTimes) {
  const auto cycles = CyclesOf(FaultKind::kStuck, FaultStream::kTip, 0.0);
  for (int i = 0; i < kCycles; ++i) {
    EXPECT_EQ(cycles[static_cast<std::size_t>(i)].tip->t_ns, Clean(i).tip->t_ns);
    EXPECT_EQ(Age(cycles, i), IsIn(i) ? i - 20 : 0) << i;
  }
}

TEST(SensorFaults, ASpikeIsOneSample) {
  const auto cycles = CyclesOf(FaultKind::kSpike, FaultStream::kTip, 0.05);
  for (int i = 0; i < kCycles; ++i)
    EXPECT_NEAR(TipOff(cycles, i).norm(), i == 20 ? 0.05 : 0.0, 1e-15) << i;
}

TEST(SensorFaults, SpikesAreOneInFiveAndPointElsewhereEachTime) {
  std::vector<Vector3d> spikes;
  SensorFaults faults({{FaultKind::kSpikes, FaultStream::kTip, 0.0, 1e9, 0.05}}, 3);
  for (int i = 0; i < 2000; ++i) {
    SensorReadings readings = Clean(i);
    faults.Disturb(TimeOf(i / kRate_hz), readings);
    const Vector3d off = readings.tip->value.tip.p_RE - Clean(i).tip->value.tip.p_RE;
    if (off.norm() > 0.0) spikes.push_back(off);
  }
  EXPECT_NEAR(static_cast<double>(spikes.size()), 400.0, 4.0 * std::sqrt(2000 * 0.2 * 0.8));
  EXPECT_NEAR(spikes[0].norm(), 0.05, 1e-12);
  EXPECT_GT((spikes[0] - spikes[1]).norm(), 1e-3);
}

TEST(SensorFaults, AnOffsetIsTheSameAllTheTimeAndADriftGrows) {
  const auto offset = CyclesOf(FaultKind::kOffset, FaultStream::kTip, 0.01);
  const auto drift = CyclesOf(FaultKind::kDrift, FaultStream::kTip, 0.01);
  for (int i = 0; i < kCycles; ++i) {
    EXPECT_NEAR(TipOff(offset, i).norm(), IsIn(i) ? 0.01 : 0.0, 1e-12);
    EXPECT_NEAR(TipOff(drift, i).norm(), IsIn(i) ? 0.01 * (i / kRate_hz - kStart_s) : 0.0, 1e-12);
  }
  EXPECT_NEAR((TipOff(offset, 21) - TipOff(offset, 40)).norm(), 0.0, 1e-12);
}

TEST(SensorFaults, ScaleAndUnitsMultiplyAndAxesSwap) {
  const Vector3d clean = Clean(30).em0->value.T_RS.p;
  EXPECT_EQ(CyclesOf(FaultKind::kScale, FaultStream::kEm0, 1.5)[30].em0->value.T_RS.p, 1.5 * clean);
  EXPECT_EQ(CyclesOf(FaultKind::kUnits, FaultStream::kEm0, 1000)[30].em0->value.T_RS.p,
            1000 * clean);
  EXPECT_EQ(CyclesOf(FaultKind::kSwappedAxes, FaultStream::kEm0, 0)[30].em0->value.T_RS.p,
            Vector3d(clean.x(), clean.z(), clean.y()));
  EXPECT_EQ(CyclesOf(FaultKind::kSwappedAxes, FaultStream::kEm0, 1)[30].em0->value.T_RS.p,
            Vector3d(clean.y(), clean.x(), clean.z()));
  EXPECT_EQ(CyclesOf(FaultKind::kSwappedAxes, FaultStream::kEm0, 2)[30].em0->value.T_RS.p,
            Vector3d(clean.z(), clean.y(), clean.x()));
  EXPECT_EQ(CyclesOf(FaultKind::kSwappedAxes, FaultStream::kStrain, 0)[30].strain->value.moments_Nm,
            Eigen::Vector4d(2.0, 31.0, 4.0, 3.0));
}

TEST(SensorFaults, NotFiniteIsNoNumberInEachStream) {
  const auto nan = [](FaultStream stream) {
    return CyclesOf(FaultKind::kNotFinite, stream, 0.0)[30];
  };
  EXPECT_TRUE(nan(FaultStream::kWrist).wrist->value.p_RW.array().isNaN().all());
  EXPECT_TRUE(nan(FaultStream::kTip).tip->value.tip.p_RE.array().isNaN().all());
  EXPECT_TRUE(nan(FaultStream::kEm0).em0->value.T_RS.p.array().isNaN().all());
  EXPECT_TRUE(nan(FaultStream::kStrain).strain->value.moments_Nm.array().isNaN().all());
  EXPECT_TRUE(nan(FaultStream::kLoad).load->value.f_tip_N.array().isNaN().all());
}

TEST(SensorFaults, DelayedSamplesKeepTheTimesTheyWereTakenAt) {
  const auto cycles = CyclesOf(FaultKind::kDelayed, FaultStream::kTip, 0.05);
  for (int i = 0; i < kCycles; ++i) {
    EXPECT_EQ(Age(cycles, i), IsIn(i) ? 5 : 0) << i;
    EXPECT_EQ(cycles[static_cast<std::size_t>(i)].tip->t_ns,
              Clean(i - (IsIn(i) ? 5 : 0)).tip->t_ns);
  }
}

TEST(SensorFaults, DroppedSamplesLeaveTheLastOne) {
  const auto all = CyclesOf(FaultKind::kDropped, FaultStream::kTip, 1.0);
  for (int i = 0; i < kCycles; ++i) EXPECT_EQ(Age(all, i), IsIn(i) ? i - 19 : 0) << i;
  const auto half = CyclesOf(FaultKind::kDropped, FaultStream::kTip, 0.5);
  int dropped = 0;
  for (int i = 20; i < 50; ++i) dropped += Age(half, i) > 0;
  EXPECT_GT(dropped, 5);
  EXPECT_LT(dropped, 25);
}

TEST(SensorFaults, RepeatedSamplesComeInThePlaceOfTheNextOnes) {
  const auto cycles = CyclesOf(FaultKind::kRepeated, FaultStream::kTip, 2.0);
  for (int i = 20; i < 50; ++i) EXPECT_EQ(Age(cycles, i), (i - 20) % 3) << i;
}

TEST(SensorFaults, OutOfOrderGoesBackAtEverySecondSample) {
  const auto cycles = CyclesOf(FaultKind::kOutOfOrder, FaultStream::kTip, 3.0);
  for (int i = 20; i < 50; ++i) EXPECT_EQ(Age(cycles, i), i % 2 == 1 ? 3 : 0) << i;
}

TEST(SensorFaults, StampsJumpAndRunByAnotherClock) {
  const auto jump = CyclesOf(FaultKind::kStampJump, FaultStream::kStrain, -0.5);
  const auto clock = CyclesOf(FaultKind::kOtherClock, FaultStream::kStrain, 1.5);
  for (int i = 0; i < kCycles; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const TimeNs clean = Clean(i).strain->t_ns;
    EXPECT_EQ(jump[at].strain->t_ns, IsIn(i) ? clean - 500'000'000 : clean);
    const double more_s = IsIn(i) ? 0.5 * (i / kRate_hz - kStart_s) : 0.0;
    EXPECT_NEAR(static_cast<double>(clock[at].strain->t_ns - clean), 1e9 * more_s, 2.0);
    EXPECT_EQ(clock[at].strain->value.moments_Nm, Clean(i).strain->value.moments_Nm);
  }
}

TEST(SensorFaults, AWrongTagIsOffAlongTheShaft) {
  const auto cycles = CyclesOf(FaultKind::kWrongTag, FaultStream::kTip, 0.006);
  EXPECT_LT((TipOff(cycles, 30) - Vector3d(0.006, 0.0, 0.0)).norm(), 1e-15);
}

TEST(SensorFaults, ASecondInstrumentStandsWhereItStands) {
  const auto cycles = CyclesOf(FaultKind::kSecondInstrument, FaultStream::kTip, 0.1);
  std::optional<Vector3d> p_other;
  int other = 0;
  for (int i = 20; i < 50; ++i) {
    if (TipOff(cycles, i).norm() == 0.0) continue;
    const Vector3d p = cycles[static_cast<std::size_t>(i)].tip->value.tip.p_RE;
    EXPECT_NEAR((p - Clean(20).tip->value.tip.p_RE).norm(), 0.1, 1e-12);
    EXPECT_LT((p - p_other.value_or(p)).norm(), 1e-12);
    p_other = p;
    ++other;
  }
  EXPECT_GT(other, 5);
  EXPECT_LT(other, 25);
}

TEST(SensorFaults, CoveredTagsLoseTheTip) {
  const auto cycles = CyclesOf(FaultKind::kTagsCovered, FaultStream::kTip, 0.0);
  for (int i = 0; i < kCycles; ++i) {
    EXPECT_EQ(cycles[static_cast<std::size_t>(i)].tip->value.tip.status,
              IsIn(i) ? TipStatus::kLost : TipStatus::kOk);
  }
}

/// The bias is linear in the place, of the size where the sensor was first.
TEST(SensorFaults, MetalBendsTheFieldByThePlace) {
  const auto cycles = CyclesOf(FaultKind::kMetal, FaultStream::kEm0, 0.01);
  const auto bias = [&](int i) -> Vector3d {
    return cycles[static_cast<std::size_t>(i)].em0->value.T_RS.p - Clean(i).em0->value.T_RS.p;
  };
  EXPECT_NEAR(bias(20).norm(), 0.01, 1e-12);
  const double along = bias(20).normalized().x();  // the sensor moves along x, 1 mm a cycle
  EXPECT_NEAR((bias(40) - bias(20)).norm(), 0.02 * std::abs(along) * 0.01 / 0.1, 1e-12);
  EXPECT_NE(bias(40), bias(20));
}

TEST(SensorFaults, ABrokenGageStandsAtItsRailAndTheOthersGoOn) {
  const auto cycles = CyclesOf(FaultKind::kGageBroken, FaultStream::kStrain, 7.0);
  int rails = 0, clean = 0;
  for (int i = 0; i < 4; ++i) {
    const double value = cycles[30].strain->value.moments_Nm[i];
    rails += value == 7.0 && cycles[45].strain->value.moments_Nm[i] == 7.0;
    clean += value == Clean(30).strain->value.moments_Nm[i];
  }
  EXPECT_EQ(rails, 1);
  EXPECT_EQ(clean, 3);
}

TEST(SensorFaults, OneStreamIsDisturbedAndNoOther) {
  const auto cycles = CyclesOf(FaultKind::kOffset, FaultStream::kLoad, 3.0);
  const SensorReadings clean = Clean(30);
  EXPECT_EQ(cycles[30].wrist->value.p_RW, clean.wrist->value.p_RW);
  EXPECT_EQ(cycles[30].em0->value.T_RS.p, clean.em0->value.T_RS.p);
  EXPECT_EQ(cycles[30].strain->value.moments_Nm, clean.strain->value.moments_Nm);
  EXPECT_EQ(TipOff(cycles, 30), Vector3d::Zero());
  EXPECT_NEAR((cycles[30].load->value.f_tip_N - clean.load->value.f_tip_N).norm(), 3.0, 1e-12);
}

TEST(SensorFaults, AreTheSameByTheirSeedAlone) {
  const Fault tip{FaultKind::kSpikes, FaultStream::kTip, 0.0, 1.0, 0.01};
  const Fault em{FaultKind::kOffset, FaultStream::kEm0, 0.0, 1.0, 0.01};
  const auto one = CyclesOf({tip}, 5), again = CyclesOf({tip, em}, 5), other = CyclesOf({tip}, 6);
  bool differs = false;
  for (int i = 0; i < kCycles; ++i) {
    EXPECT_EQ(TipOff(one, i), TipOff(again, i));
    differs |= TipOff(one, i) != TipOff(other, i);
  }
  EXPECT_TRUE(differs);
}

TEST(SensorFaults, RefusesAFaultThatAStreamCannotHave) {
  EXPECT_THROW(SensorFaults({{FaultKind::kWrongTag, FaultStream::kWrist, 0, 1, 1}}, 1), InputError);
  EXPECT_THROW(SensorFaults({{FaultKind::kOffset, FaultStream::kTip, 0, 1, NAN}}, 1), InputError);
}

TEST(Faults, HaveNamesThatLeadBack) {
  for (int i = 0; i < kFaultKinds; ++i)
    EXPECT_EQ(FaultKindNamed(Name(static_cast<FaultKind>(i))), static_cast<FaultKind>(i));
  for (int i = 0; i < kFaultStreams; ++i)
    EXPECT_EQ(FaultStreamNamed(Name(static_cast<FaultStream>(i))), static_cast<FaultStream>(i));
  EXPECT_FALSE(FaultKindNamed("tea"));
}

}  // namespace
}  // namespace flextip::simulation
