#include "simulation/effects/catalogue.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>

#include "core/error.h"

namespace flextip::simulation {
namespace {

using Values = std::span<const double>;

template <int N>
Eigen::Matrix<double, N, 1> Vector(Values values) {
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(values.data());
}

Eigen::Matrix3d MatrixByRows(Values values) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
}

constexpr double kZeros[12] = {}, kOnes[4] = {1.0, 1.0, 1.0, 1.0};
constexpr double kBreath_hz[1] = {0.25}, kMotor_hz[1] = {5.0}, kAxisX[3] = {1.0, 0.0, 0.0};
constexpr double kPulley_m[1] = {0.02};
constexpr Values Zeros(std::size_t count) { return Values(kZeros).first(count); }
constexpr Values Ones(std::size_t count) { return Values(kOnes).first(count); }

/// The off-diagonal entries, row by row.
Eigen::Matrix4d OffDiagonal(Values values) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  std::size_t next = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if (i != j) matrix(i, j) = values[next++];
  return matrix;
}

constexpr EffectParameter kCatalogue[] = {
    {"stiffness", "scale", Ones(1),
     [](Values v, InstrumentEffects& e) { e.plant.stiffness_scale = v[0]; }},
    {"length", "delta_m", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.length_delta_m = v[0]; }},
    {"self_weight", "mass_per_length_kg_m", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.mass_per_length_kg_m = v[0]; }},
    {"precurvature", "curvature_1_m", Zeros(2),
     [](Values v, InstrumentEffects& e) { e.plant.curvature_1_m = Vector<2>(v); }},
    {"port_offset", "offset_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.plant.port_offset_m = Vector<3>(v); }},
    {"port_motion", "amplitude_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.plant.port_motion.amplitude_m = Vector<3>(v); }},
    {"port_motion", "frequency_hz", kBreath_hz,
     [](Values v, InstrumentEffects& e) { e.plant.port_motion.frequency_hz = v[0]; }},
    {"port_motion", "phase_rad", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.port_motion.phase_rad = v[0]; }},
    {"port_compliance", "compliance_m_N", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.port_compliance_m_N = v[0]; }},
    {"port_friction", "coefficient", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.port_friction.coefficient = v[0]; }},
    {"port_moment", "stiffness_Nm_rad", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.port_stiffness_Nm_rad = v[0]; }},
    {"port_moment", "rest_axis", kAxisX,
     [](Values v, InstrumentEffects& e) { e.plant.port_rest_axis = Vector<3>(v); }},
    {"shaft_load", "force_per_length_N_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.plant.shaft_load_N_m = Vector<3>(v); }},
    {"wrist_compliance", "compliance_m_N", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.wrist_compliance_m_N = v[0]; }},
    {"tip_compliance", "compliance_m_N", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.tip_compliance_m_N = v[0]; }},
    {"backlash", "width_m", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.backlash_m = v[0]; }},
    {"em_distortion", "gradient", Zeros(9),
     [](Values v, InstrumentEffects& e) { e.sensors.em_gradient = MatrixByRows(v); }},
    {"em_distortion", "offset_at_centre_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.em_offset_m = Vector<3>(v); }},
    {"em_latency", "delay_s", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.em_latency_s = v[0]; }},
    {"camera_latency", "delay_s", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.camera_latency_s = v[0]; }},
    {"hand_eye", "rotation_rad", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.hand_eye_rotation_rad = Vector<3>(v); }},
    {"hand_eye", "translation_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.hand_eye_translation_m = Vector<3>(v); }},
    {"focal_length", "scale", Ones(1),
     [](Values v, InstrumentEffects& e) { e.sensors.focal_scale = v[0]; }},
    {"tag_offset", "offset_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.tag_offset_m = Vector<3>(v); }},
    {"strain_gain", "gain", Ones(4),
     [](Values v, InstrumentEffects& e) { e.sensors.strain_gain = Vector<4>(v); }},
    {"strain_drift", "rate_Nm_s", Zeros(4),
     [](Values v, InstrumentEffects& e) { e.sensors.strain_drift_Nm_s = Vector<4>(v); }},
    {"gage_rotation", "angle_rad", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.gage_rotation_rad = v[0]; }},
    {"strain_crosstalk", "matrix", Zeros(12),
     [](Values v, InstrumentEffects& e) { e.sensors.strain_crosstalk = OffDiagonal(v); }},
    {"wrist_scale", "scale", Ones(1),
     [](Values v, InstrumentEffects& e) { e.plant.wrist_reading.scale = v[0]; }},
    {"encoder_eccentricity", "amplitude_m", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.wrist_reading.eccentricity_m = v[0]; }},
    {"encoder_eccentricity", "wavelength_m", kPulley_m,
     [](Values v, InstrumentEffects& e) { e.plant.wrist_reading.wavelength_m = v[0]; }},
    {"encoder_eccentricity", "phase_rad", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.plant.wrist_reading.phase_rad = v[0]; }},
    {"em_clock", "rate", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.em_clock_rate = v[0]; }},
    {"camera_clock", "rate", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.camera_clock_rate = v[0]; }},
    {"load_scale", "scale", Ones(1),
     [](Values v, InstrumentEffects& e) { e.sensors.load_scale = v[0]; }},
    {"load_rotation", "rotation_rad", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.load_rotation_rad = Vector<3>(v); }},
    {"lens_radial", "k1", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.lens_k1 = v[0]; }},
    {"camera_drift", "rotation_rate_rad_s", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.camera_drift_rad_s = Vector<3>(v); }},
    {"camera_drift", "translation_rate_m_s", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.camera_drift_m_s = Vector<3>(v); }},
    {"em_interference", "amplitude_m", Zeros(3),
     [](Values v, InstrumentEffects& e) { e.sensors.em_interference.amplitude_m = Vector<3>(v); }},
    {"em_interference", "frequency_hz", kMotor_hz,
     [](Values v, InstrumentEffects& e) { e.sensors.em_interference.frequency_hz = v[0]; }},
    {"em_interference", "phase_rad", Zeros(1),
     [](Values v, InstrumentEffects& e) { e.sensors.em_interference.phase_rad = v[0]; }},
};

const EffectParameter* Find(std::string_view effect, std::string_view parameter) {
  const auto* const row = std::find_if(
      std::begin(kCatalogue), std::end(kCatalogue),
      [&](const EffectParameter& p) { return p.effect == effect && p.name == parameter; });
  return row == std::end(kCatalogue) ? nullptr : row;
}

std::string ParametersOf(const std::string& effect) {
  std::string known;
  for (const auto& [name, neutral] : NeutralEffects().at(effect))
    known += (known.empty() ? "" : ", ") + name;
  return known;
}

}  // namespace

const std::vector<std::string>& CatalogueEffects() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> unique;
    for (const EffectParameter& row : kCatalogue) {
      if (unique.empty() || unique.back() != row.effect) unique.emplace_back(row.effect);
    }
    return unique;
  }();
  return names;
}

const EffectValues& NeutralEffects() {
  static const EffectValues neutral = [] {
    EffectValues values;
    for (const EffectParameter& row : kCatalogue)
      values[std::string(row.effect)][std::string(row.name)].assign(row.neutral.begin(),
                                                                    row.neutral.end());
    return values;
  }();
  return neutral;
}

const EffectParameter& FindEffectParameter(std::string_view effect, std::string_view parameter) {
  const EffectParameter* row = Find(effect, parameter);
  if (row == nullptr) throw std::out_of_range(fmt::format("no effect {}.{}", effect, parameter));
  return *row;
}

InstrumentEffects EffectsOf(const EffectValues& values) {
  InstrumentEffects effects;
  for (const EffectParameter& row : kCatalogue) row.set(row.neutral, effects);
  for (const auto& [effect, parameters] : values) {
    if (!NeutralEffects().contains(effect)) {
      throw InputError(fmt::format("effect '{}' is unknown, expected one of {}", effect,
                                   fmt::join(CatalogueEffects(), ", ")));
    }
    for (const auto& [name, numbers] : parameters) {
      const EffectParameter* row = Find(effect, name);
      if (row == nullptr) {
        throw InputError(fmt::format("{} has no parameter '{}', expected {}", effect, name,
                                     ParametersOf(effect)));
      }
      if (numbers.size() != row->neutral.size()) {
        throw InputError(fmt::format("{}.{}: found {} numbers, expected {}", effect, name,
                                     numbers.size(), row->neutral.size()));
      }
      row->set(numbers, effects);
    }
  }
  return effects;
}

InstrumentEffects EffectsOfWholeMass(EffectValues values, const Instrument& nominal) {
  InstrumentEffects effects = EffectsOf(values);
  const auto weight = values.find("self_weight");
  if (weight != values.end() && weight->second.contains("mass_per_length_kg_m"))
    effects.plant.mass_per_length_kg_m -= nominal.mass_per_length_kg_m;
  return effects;
}

}  // namespace flextip::simulation
