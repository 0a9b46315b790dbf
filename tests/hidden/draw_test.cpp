// What is drawn: sizes, tolerances, limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "testdata/hidden/draw.h"

namespace flextip::hidden {
namespace {

struct Limits {
  const char *effect, *parameter;
  double neutral, tolerance, highest;
};

// docs/effects.md, and the largest deviation that is plausible.
constexpr Limits kLimits[] = {
    {"stiffness", "scale", 1, 0.02, 0.5},
    {"length", "delta_m", 0, 0.0003, 0.008},
    {"self_weight", "mass_per_length_kg_m", 0, 0.003, 0.15},
    {"precurvature", "curvature_1_m", 0, 0.003, 0.3},
    {"port_offset", "offset_m", 0, 0.0003, 0.008},
    {"port_motion", "amplitude_m", 0, 0.0001, 0.004},
    {"port_compliance", "compliance_m_N", 0, 0.00003, 0.002},
    {"port_friction", "coefficient", 0, 0.03, 0.6},
    {"port_moment", "stiffness_Nm_rad", 0, 0.005, 0.3},
    {"shaft_load", "force_per_length_N_m", 0, 0.02, 1.0},
    {"wrist_compliance", "compliance_m_N", 0, 0.00003, 0.002},
    {"tip_compliance", "compliance_m_N", 0, 0.00003, 0.002},
    {"backlash", "width_m", 0, 0.0001, 0.003},
    {"em_latency", "delay_s", 0, 0.003, 0.15},
    {"camera_latency", "delay_s", 0, 0.003, 0.15},
    {"hand_eye", "rotation_rad", 0, 0.001, 0.04},
    {"hand_eye", "translation_m", 0, 0.0002, 0.006},
    {"focal_length", "scale", 1, 0.002, 0.1},
    {"tag_offset", "offset_m", 0, 0.0002, 0.004},
};

double Deviation(const HiddenLabel& label, const Limits& row) {
  double squares = 0.0;
  for (const double x : label.parameters.at(row.effect).at(row.parameter)) {
    squares += (x - row.neutral) * (x - row.neutral);
  }
  return std::sqrt(squares);
}

TEST(HiddenDraw, PresentEffectsHaveTheirSize) {
  const double range[3][2] = {{3, 5}, {8, 20}, {20, 40}};
  std::mt19937_64 rng(1);
  for (const Limits& row : kLimits) {
    for (int size = 0; size < 3; ++size) {
      for (int i = 0; i < 50; ++i) {
        const HiddenLabel label =
            DrawEffects({.present = {row.effect}, .size = static_cast<EffectSize>(size)}, rng);
        const double deviation = Deviation(label, row);
        EXPECT_LE(deviation, std::min(row.highest, range[size][1] * row.tolerance) * 1.000001)
            << row.effect;
        EXPECT_GE(deviation, std::min(0.8 * row.highest, range[size][0] * row.tolerance) * 0.999999)
            << row.effect;
      }
    }
  }
}

/// A normal cut off at two standard deviations: its second and fourth moments are
/// 1 - 2 c phi(c) / (2 Phi(c) - 1) and 3 times that less 2 c^3 phi(c) / (2 Phi(c) - 1), c = 2.
TEST(HiddenDraw, AbsentParametersAreNormalWithTheirToleranceUpToTwice) {
  constexpr double kSecond = 0.773741, kFourth = 1.416189;
  std::mt19937_64 rng(2);
  constexpr int kDraws = 2000;
  for (const Limits& row : kLimits) {
    double squares = 0.0;
    int count = 0;
    for (int i = 0; i < kDraws; ++i) {
      const HiddenLabel label = DrawEffects({.present = {"em_distortion"}}, rng);
      const auto& values = label.parameters.at(row.effect).at(row.parameter);
      for (const double x : values) {
        EXPECT_LE(std::abs(x - row.neutral), 2.000001 * row.tolerance) << row.effect;
        squares += std::pow((x - row.neutral) / row.tolerance, 2);
      }
      count += static_cast<int>(values.size());
    }
    const double sd = std::sqrt((kFourth - kSecond * kSecond) / count);
    EXPECT_NEAR(squares / count, kSecond, 4.5 * sd) << row.effect;
  }
}

TEST(HiddenDraw, GagesOneToFourAreOff) {
  std::mt19937_64 rng(3);
  int seen[5] = {};
  for (int i = 0; i < 400; ++i) {
    const HiddenLabel label = DrawEffects({.present = {"strain_gain"}}, rng);
    int off = 0;
    for (const double x : label.parameters.at("strain_gain").at("gain")) {
      EXPECT_LE(std::abs(x - 1.0), 0.3);
      off += std::abs(x - 1.0) > 0.07;
    }
    ++seen[off];
  }
  EXPECT_EQ(seen[0], 0);
  for (int off = 1; off <= 4; ++off) EXPECT_GT(seen[off], 50) << off;
}

TEST(HiddenDraw, EmGradientEntriesHaveTheirSize) {
  std::mt19937_64 rng(4);
  for (int i = 0; i < 100; ++i) {
    const HiddenLabel label =
        DrawEffects({.present = {"em_distortion"}, .size = EffectSize::kPlain}, rng);
    const Eigen::Matrix3d gradient = simulation::EffectsOf(label.parameters).sensors.em_gradient;
    EXPECT_LE(gradient.cwiseAbs().maxCoeff(), 0.03);
    EXPECT_GE(gradient.norm() / 3.0, 0.0075);
    EXPECT_LE(gradient.norm() / 3.0, 0.0201);
  }
}

TEST(HiddenDraw, ExactIsNeutral) {
  std::mt19937_64 rng(5);
  const HiddenLabel label = DrawEffects({.exact = true}, rng);
  for (const Limits& row : kLimits) EXPECT_EQ(Deviation(label, row), 0.0) << row.effect;
  const simulation::PlantEffects plant = simulation::EffectsOf(label.parameters).plant;
  const simulation::PlantEffects none;
  EXPECT_EQ(plant.stiffness_scale, none.stiffness_scale);
  EXPECT_EQ(plant.port_motion.amplitude_m, none.port_motion.amplitude_m);
  EXPECT_EQ(simulation::EffectsOf(label.parameters).sensors.strain_gain,
            simulation::SensorEffects{}.strain_gain);
}

TEST(HiddenDraw, OtherParametersDoNotChangeWithWhatIsPresent) {
  std::mt19937_64 a(6), b(6);
  HiddenLabel healthy = DrawEffects({}, a), sick = DrawEffects({.present = {"backlash"}}, b);
  EXPECT_NE(healthy.parameters["backlash"], sick.parameters["backlash"]);
  healthy.parameters.erase("backlash");
  sick.parameters.erase("backlash");
  EXPECT_EQ(healthy.parameters, sick.parameters);
}

TEST(HiddenDraw, ParametersReachPlantAndSensors) {
  std::mt19937_64 rng(7);
  const HiddenLabel label = DrawEffects({}, rng);
  const auto value = [&](const char* effect, const char* parameter, int i = 0) {
    return label.parameters.at(effect).at(parameter).at(i);
  };
  const simulation::PlantEffects plant = simulation::EffectsOf(label.parameters).plant;
  const simulation::SensorEffects sensors = simulation::EffectsOf(label.parameters).sensors;
  EXPECT_EQ(plant.curvature_1_m.y(), value("precurvature", "curvature_1_m", 1));
  EXPECT_EQ(plant.port_friction.coefficient, value("port_friction", "coefficient"));
  EXPECT_EQ(plant.shaft_load_N_m.z(), value("shaft_load", "force_per_length_N_m", 2));
  EXPECT_EQ(plant.port_rest_axis.y(), value("port_moment", "rest_axis", 1));
  EXPECT_EQ(sensors.em_gradient(0, 1), value("em_distortion", "gradient", 1));
  EXPECT_EQ(sensors.focal_scale, value("focal_length", "scale"));
  EXPECT_EQ(sensors.strain_drift_Nm_s[3], value("strain_drift", "rate_Nm_s", 3));
}

TEST(HiddenDraw, UnknownNameIsAnInputError) {
  std::mt19937_64 rng(8);
  EXPECT_THROW(DrawEffects({.present = {"gremlins"}}, rng), InputError);
}

}  // namespace
}  // namespace flextip::hidden
