// Whatever the sensors say, an estimate is finite and says what it is worth
// (docs/notes/robustness_control.md).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimation/shaft_estimator.h"
#include "sensor_bench.h"
#include "tests/hostile_numbers.h"

namespace flextip {
namespace {

constexpr int kEverySensor =
    kWristDirection | kTip | kTipDirection | kEm | kStrain | kLoad | kPortDirection;

void AddNumbersOf(Measurements& z, std::vector<double*>& numbers) {
  AddNumbers(z.p_RW, numbers);
  numbers.push_back(&z.wrist_position_noise_m);
  if (z.R_RW) {
    AddNumbers(*z.R_RW, numbers);
    numbers.push_back(&z.wrist_orientation_noise_rad);
  }
  if (z.tip) {
    AddNumbers(z.tip->p_RE, numbers);
    AddNumbers(z.tip->covariance_m2, numbers);
    if (z.tip->d_RE) {
      AddNumbers(*z.tip->d_RE, numbers);
      numbers.push_back(&z.tip_direction_noise_rad);
    }
  }
  if (z.em) {
    AddNumbers(z.em->T_RS.p, numbers);
    AddNumbers(z.em->T_RS.R, numbers);
    for (double* n :
         {&z.em->distance_from_tip_m, &z.em->position_noise_m, &z.em->orientation_noise_rad}) {
      numbers.push_back(n);
    }
  }
  if (z.port_direction) {
    AddNumbers(*z.port_direction, numbers);
    numbers.push_back(&z.port_direction_noise_rad);
  }
  if (z.strain) {
    AddNumbers(z.strain->moments_Nm, numbers);
    for (double& s : z.strain->station_from_wrist_m) numbers.push_back(&s);
    numbers.push_back(&z.strain->moment_noise_Nm);
  }
  if (z.load) {
    AddNumbers(z.load->f_tip_N, numbers);
    numbers.push_back(&z.load->force_noise_N);
  }
}

void AddNumbersOf(ShaftChange& c, std::vector<double*>& numbers) {
  for (double* n : {&c.stiffness_scale, &c.length_delta_m, &c.tip_compliance_m_N, &c.wrist_play_m,
                    &c.effects.port_compliance_m_N, &c.effects.wrist_compliance_m_N,
                    &c.effects.port_friction}) {
    numbers.push_back(n);
  }
  for (Eigen::Vector3d* v :
       {&c.weight_N_m, &c.wrist_shift_m, &c.wrist_misread_m, &c.port_shift_m, &c.effects.y_wrist,
        &c.effects.port_couple_Nm, &c.effects.q_inside_N_m}) {
    AddNumbers(*v, numbers);
  }
  AddNumbers(c.effects.curvature_1_m, numbers);
}

void ExpectFinite(const ShaftEstimate& e) {
  const ShaftModel& m = e.model;
  ASSERT_TRUE(e.p_RE.allFinite() && e.d_RE.allFinite() && e.covariance.allFinite() &&
              e.p_RE_covariance_m2.allFinite() && std::isfinite(e.chi2) &&
              std::isfinite(e.s_port_m))
      << Name(e.status);
  ASSERT_TRUE(m.p_RP.allFinite() && m.f_tip_N.allFinite() && m.weight_N_m.allFinite() &&
              m.tissue_stiffness_N_m.allFinite() && m.wrist_shift_m.allFinite() &&
              std::isfinite(m.instrument.length_m) &&
              std::isfinite(m.instrument.bending_stiffness_Nm2))
      << Name(e.status);
  if (m.beam.IsUsable()) {
    ASSERT_TRUE(std::isfinite(m.beam.F_p_over_EI) && std::isfinite(m.beam.a) &&
                m.beam.R_RM.allFinite());
  }
}

/// Every number of the measurements in turn, made none.
TEST(HostileEstimate, ANumberThatIsNoneIsBadInput) {
  SensorBench bench;
  const Measurements good = bench.Measure(BenchShaft(), kEverySensor, 0.0);
  Measurements copy = good;
  std::vector<double*> numbers;
  AddNumbersOf(copy, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), -1e300}) {
      const double right = *numbers[i];
      *numbers[i] = wrong;
      ShaftEstimator estimator(BenchOptions());
      const ShaftEstimate e = estimator.Update(copy);
      EXPECT_EQ(e.status, EstimateStatus::kBadInput) << i << ", " << wrong;
      ExpectFinite(e);
      // Nothing of it stays.
      EXPECT_EQ(estimator.Update(good).status, EstimateStatus::kOk);
      *numbers[i] = right;
    }
  }
}

TEST(HostileEstimate, NoNumberBreaksAnEstimator) {
  Hostile hostile(21);
  SensorBench bench;
  std::vector<Measurements> goods;
  for (int sensors = 0; sensors < 128; ++sensors)
    goods.push_back(bench.Measure(BenchShaft(), sensors, 1.0));
  ShaftEstimator estimator(BenchOptions());
  long ok = 0;
  const long trials = HostileTrials(20'000);
  for (long i = 0; i < trials && !HasFailure(); ++i) {
    if (i % 50 == 0) {
      EstimatorOptions options = BenchOptions(!hostile.OneIn(4));
      std::vector<double*> numbers = {&options.instrument.length_m,
                                      &options.instrument.bending_stiffness_Nm2,
                                      &options.instrument.mass_per_length_kg_m,
                                      &options.instrument.stiffness_taper,
                                      &options.port_prior_m,
                                      &options.force_prior_units};
      AddNumbers(options.p_RP, numbers);
      AddNumbers(options.gravity_m_s2, numbers);
      if (hostile.OneIn(8)) hostile.Break(numbers);
      estimator = ShaftEstimator(options);
    }
    Measurements z = goods[hostile.Below(128)];
    ShaftChange change;
    if (hostile.OneIn(16)) {
      change.effects.curvature_1_m = {0.1, -0.05};
      change.effects.port_compliance_m_N = 3e-4;
    }
    std::vector<double*> numbers;
    AddNumbersOf(z, numbers);
    if (hostile.OneIn(4)) AddNumbersOf(change, numbers);
    if (!hostile.OneIn(8)) hostile.Break(numbers);
    const ShaftEstimate e = estimator.Update(z, change);
    ExpectFinite(e);
    if (e.status == EstimateStatus::kOk) {
      ++ok;
      EXPECT_TRUE(z.p_RW.allFinite() && IsPlausible(e.model));
    }
  }
  EXPECT_GT(ok, trials / 10);
}

}  // namespace
}  // namespace flextip
