// The plant against a healthy recording of another program's plant: forced with the recorded wrist
// and load, it must give the other sensors' values within their noise. This fixes the signs of the
// moments, the carried frames and the quaternions.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/rotation.h"
#include "recording/recording_reader.h"
#include "simulation/plant/plant.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;
using Signals = Eigen::Matrix<double, 13, 1>;  // em position, direction; strain; wrist direction

Signals SignalsOf(const PlantShape& shape, const Recording& recording) {
  const Pose T_RS = shape.Frame(shape.length_m - recording.em0->distance_from_tip_m);
  Signals z;
  z.segment<3>(0) = T_RS.p;
  z.segment<3>(3) = T_RS.R.col(0);
  for (int k = 0; k < 2; ++k) {
    const double s = recording.strain0->station_from_wrist_m[k];
    const Vector3d m = shape.Frame(s).R.transpose() * shape.Moment(s);
    z.segment<2>(6 + 2 * k) = m.tail<2>();
  }
  z.segment<3>(10) = shape.T_RW().R.col(0);
  return z;
}

TEST(PlantReplay, HealthyRecordingIsReproducedToItsNoise) {
  const std::string folder = FLEXTIP_SOURCE_DIR "/testdata/recordings/sample_0";
  const Recording recording = ReadRecording(folder).recording;
  const auto& wrist = recording.wrist0->samples;
  PlantSetup setup;
  setup.instrument = recording.instrument;
  setup.p_RP = recording.p_RP;
  Plant plant(setup);
  const auto predict = [&](const Vector3d& p_RW, const Vector3d& force) {
    plant.SetLoad({force, {}});
    const PlantShape shape = plant.Solve(p_RW);
    EXPECT_TRUE(shape.IsUsable()) << shape.message;
    return SignalsOf(shape, recording);
  };

  Signals chi2 = Signals::Zero();
  Vector3d carried = Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < wrist.size(); i += 5) {
    const Vector3d p_RW = wrist[i].value.p_RW;
    const Vector3d force = recording.load0->f_tip_N.at(i).value;
    const Signals expected = predict(p_RW, force);
    // The noise of what the plant was forced with, carried to the signals by differences.
    Eigen::Matrix<double, 13, 6> J;
    for (int k = 0; k < 3; ++k) {
      const double dp = 1e-5, df = 1e-3;
      J.col(k) = (predict(p_RW + dp * Vector3d::Unit(k), force) - expected) / dp;
      J.col(3 + k) = (predict(p_RW, force + df * Vector3d::Unit(k)) - expected) / df;
    }
    Eigen::Matrix<double, 6, 1> forced;
    forced << Vector3d::Constant(recording.wrist0->position_noise_m),
        Vector3d::Constant(recording.load0->force_noise_N);
    Signals variance = (J * forced.asDiagonal()).rowwise().squaredNorm();
    const EmSample& em = recording.em0->samples.at(i).value;
    const Vector3d em_x = em.q_RS * Vector3d::UnitX();
    const Vector3d wrist_x = *wrist[i].value.q_RW * Vector3d::UnitX();
    const double em_turn = recording.em0->orientation_noise_rad;
    const double wrist_turn = recording.wrist0->orientation_noise_rad;
    for (int k = 0; k < 3; ++k) {
      variance[k] += std::pow(recording.em0->position_noise_m, 2);
      variance[3 + k] += em_turn * em_turn * (1 - em_x[k] * em_x[k]);
      variance[10 + k] += wrist_turn * wrist_turn * (1 - wrist_x[k] * wrist_x[k]);
    }
    variance.segment<4>(6).array() += std::pow(recording.strain0->moment_noise_Nm, 2);
    Signals found;
    found << em.p_RS, em_x, recording.strain0->moments_Nm.at(i).value, wrist_x;
    chi2 += ((found - expected).array().square() / variance.array()).matrix();

    plant.SetLoad({force, {}});
    const PlantShape shape = plant.Solve(p_RW);
    carried += (shape.Frame(shape.length_m - 0.02).R.transpose() * em.q_RS.toRotationMatrix() -
                shape.T_RW().R.transpose() * wrist[i].value.q_RW->toRotationMatrix())
                   .row(2)
                   .transpose();
    ++count;
  }
  chi2 /= count;
  for (int k = 0; k < 13; ++k) {
    RecordProperty("chi2_" + std::to_string(k), std::to_string(chi2[k]));
    EXPECT_GT(chi2[k], 0.7) << "signal " << k;
    EXPECT_LT(chi2[k], 1.35) << "signal " << k;
  }
  std::printf("chi2 per sample of 13 signals: ");
  for (double x : chi2) std::printf("%.2f ", x);
  std::printf("(%d samples)\n", count);
  EXPECT_LT(std::abs(carried[1]) / count, 2e-4);  // rad: the turn about the shaft agrees
}

}  // namespace
}  // namespace flextip::simulation
