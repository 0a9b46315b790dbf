// Each sensor against all others, by fits without it.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "core/draw_vector.h"
#include "estimation/shaft_estimator.h"
#include "sensor_bench.h"

namespace flextip {
namespace {

// In the order of ShaftEstimate::misfits.
enum : std::size_t { kWristPlace, kTurn, kTipRows, kEmRows, kPortRows, kStrainRows, kLoadRows };

constexpr int kAll =
    kWristDirection | kTip | kTipDirection | kEm | kPortDirection | kStrain | kLoad;

EstimatorOptions Options() {
  EstimatorOptions options;
  options.instrument.length_m = kBenchLength;
  options.instrument.bending_stiffness_Nm2 = kBenchStiffness;
  options.p_RP = kBenchPort;
  options.compare_sensors = true;
  return options;
}

/// Chi-squared of a fit from nothing.
ShaftEstimate Fit(const Measurements& z) { return ShaftEstimator(Options()).Update(z); }

TEST(SensorMisfit, IsWhatChiSquaredFallsByWithoutTheSensor) {
  SensorBench bench;
  int large = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Measurements z = bench.Measure(BenchShaft(), kAll, trial % 2 ? 1.0 : 2.0);
    const ShaftEstimate all = Fit(z);
    ASSERT_EQ(all.status, EstimateStatus::kOk);
    // What the others know ten times worse than the sensor is not compared: the wrist's place in
    // part, and the load along the shaft. There the fall is a bound.
    const auto expect = [&](std::size_t sensor, int degrees, const Measurements& rest) {
      const double fall = all.chi2 - Fit(rest).chi2;
      EXPECT_EQ(all.misfits[sensor].degrees, degrees);
      const double misfit = all.misfits[sensor].chi2;
      EXPECT_LE(misfit, 1.05 * fall + 0.05) << sensor;
      if (sensor != kWristPlace && sensor != kLoadRows) EXPECT_GE(misfit, 0.95 * fall - 0.05);
      if (sensor == kWristPlace) EXPECT_GE(misfit, 0.7 * fall - 0.05);
      large += fall > 5.0;
    };
    struct Sensor {
      std::size_t index;
      int degrees;
      void (*drop)(Measurements&);
    };
    const std::array<Sensor, 6> sensors{{
        {kWristPlace, 3, [](Measurements& rest) { rest.wrist_position_noise_m = 1.0; }},
        {kTipRows, 5, [](Measurements& rest) { rest.tip.reset(); }},
        {kEmRows, 5, [](Measurements& rest) { rest.em.reset(); }},
        {kPortRows, 2, [](Measurements& rest) { rest.port_direction.reset(); }},
        {kStrainRows, 4, [](Measurements& rest) { rest.strain.reset(); }},
        {kLoadRows, 3, [](Measurements& rest) { rest.load.reset(); }},
    }};
    for (const Sensor& sensor : sensors) {
      Measurements rest = z;
      sensor.drop(rest);
      expect(sensor.index, sensor.degrees, rest);
    }
    // The gages' axes hang on the wrist's turn.
    EXPECT_EQ(all.misfits[kTurn].degrees, 2);
  }
  EXPECT_GT(large, 40);
}

TEST(SensorMisfit, ASensorThatIsAloneMisfitsNobody) {
  SensorBench bench;
  const Measurements z = bench.Measure(BenchShaft(), kTip, 1.0);
  const ShaftEstimate estimate = Fit(z);
  EXPECT_EQ(estimate.misfits[kTipRows].degrees, 3);
  EXPECT_LT(estimate.misfits[kTipRows].chi2, 1.0);
  EXPECT_EQ(estimate.misfits[kEmRows].degrees, 0);
  EXPECT_EQ(estimate.misfits[kEmRows].chi2, 0.0);
}

}  // namespace
}  // namespace flextip
