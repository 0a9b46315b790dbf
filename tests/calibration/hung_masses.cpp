#include "tests/calibration/hung_masses.h"

#include <gtest/gtest.h>

#include <random>

#include "core/rotation.h"
#include "simulation/plant/plant.h"

namespace flextip::test_support {
namespace {

class Noise {
 public:
  explicit Noise(std::uint64_t seed) : rng_(seed) {}
  template <int N>
  Eigen::Matrix<double, N, 1> Of(double sd) {
    Eigen::Matrix<double, N, 1> v;
    for (double& x : v) x = sd * normal_(rng_);
    return v;
  }

 private:
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
};

Eigen::Vector4d LocalMoments(const simulation::PlantShape& shape) {
  Eigen::Vector4d m;
  const double stations[] = {0.12, 0.5};
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d local =
        shape.Frame(stations[i]).R.transpose() * shape.Moment(stations[i]);
    m.segment<2>(2 * i) = local.tail<2>();
  }
  return m;
}

void Describe(const Bench& bench, Recording& r) {
  const BenchNoise& n = bench.noise;
  r.instrument = bench.instrument;
  r.wrist0.emplace();
  r.wrist0->rate_hz = 10;
  r.wrist0->position_noise_m = n.wrist_m;
  r.wrist0->orientation_noise_rad = n.wrist_rad;
  r.load0.emplace();
  r.load0->rate_hz = 10;
  r.load0->force_noise_N = n.force_N;
  r.strain0.emplace();
  r.strain0->rate_hz = 10;
  r.strain0->station_from_wrist_m[0] = 0.12;
  r.strain0->station_from_wrist_m[1] = 0.5;
  r.strain0->moment_noise_Nm = n.reading;
  r.vision0.emplace();
  r.vision0->rate_hz = 10;
  r.vision0->direction_noise_rad = n.direction_rad;
  r.em0.emplace();
  r.em0->rate_hz = 10;
  r.em0->distance_from_tip_m = bench.em_from_tip_m;
  r.em0->position_noise_m = n.em_m;
  r.em0->orientation_noise_rad = n.em_rad;
}

}  // namespace

std::vector<simulation::PlantShape> Hang(const Bench& bench, const std::vector<HungMass>& masses) {
  simulation::PlantSetup setup;
  setup.instrument = bench.instrument;
  setup.p_RP = bench.p_RP;
  setup.gravity_m_s2.setZero();
  setup.effects = bench.effects;
  simulation::Plant plant(setup);
  std::vector<simulation::PlantShape> shapes;
  for (const HungMass& mass : masses) {
    simulation::TipLoad load;
    load.constant_N = mass.f_N;
    plant.SetLoad(load);
    plant.SetRoll(mass.roll_rad);
    shapes.push_back(plant.Solve(mass.p_RW));
    EXPECT_TRUE(shapes.back().IsUsable()) << shapes.back().message;
  }
  return shapes;
}

Recording RecordBench(const Bench& bench, const std::vector<HungMass>& masses,
                      const std::vector<simulation::PlantShape>& shapes, std::uint64_t seed) {
  Noise noise(seed);
  const BenchNoise& n = bench.noise;
  Recording r;
  Describe(bench, r);
  r.gravity_m_s2.setZero();
  r.p_RP = bench.p_RP + noise.Of<3>(n.port_m);
  TimeNs t_ns = 1'700'000'000'000'000'000;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const simulation::PlantShape& shape = shapes[i];
    const Eigen::Vector3d stated_N = masses[i].f_N + noise.Of<3>(n.force_N);
    const Pose T_RW = shape.T_RW(), T_RE = shape.T_RE(),
               T_RS = shape.Frame(shape.length_m - bench.em_from_tip_m);
    const auto turned = [&](const Eigen::Matrix3d& R, double sd) {
      return Eigen::Quaterniond(ExpRotation(noise.Of<3>(sd)) * R);
    };
    for (int k = 0; k < bench.samples; ++k, t_ns += 100'000'000) {
      r.load0->f_tip_N.push_back({t_ns, stated_N});
      r.wrist0->samples.push_back(
          {t_ns, {shape.p_RW_measured + noise.Of<3>(n.wrist_m), turned(T_RW.R, n.wrist_rad)}});
      r.strain0->moments_Nm.push_back(
          {t_ns, bench.gains * LocalMoments(shape) + bench.offset + noise.Of<4>(n.reading)});
      TipObservation tip;
      tip.status = TipStatus::kOk;
      tip.p_RE = T_RE.p + noise.Of<3>(n.tip_m);
      tip.covariance_m2 = n.tip_m * n.tip_m * Eigen::Matrix3d::Identity();
      tip.d_RE = ExpRotation(noise.Of<3>(n.direction_rad)) * T_RE.R.col(0);
      r.vision0->tips.push_back({t_ns, tip});
      r.em0->samples.push_back({t_ns, {T_RS.p + noise.Of<3>(n.em_m), turned(T_RS.R, n.em_rad)}});
    }
  }
  return r;
}

std::vector<HungMass> AllWays(const std::vector<double>& wrist_x_m,
                              const std::vector<double>& forces_N) {
  std::vector<HungMass> masses;
  for (const double x : wrist_x_m) {
    masses.push_back({{x, 0, 0}, Eigen::Vector3d::Zero()});
    for (const double f : forces_N) {
      for (const Eigen::Vector3d& way : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1),
                                         Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, -1)}) {
        masses.push_back({{x, 0, 0}, f * way});
      }
    }
  }
  return masses;
}

}  // namespace flextip::test_support
