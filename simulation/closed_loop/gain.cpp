#include "simulation/closed_loop/gain.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "diagnosis/model/extended_instrument.h"
#include "simulation/closed_loop/closed_loop.h"
#include "simulation/effects/catalogue.h"

namespace flextip::simulation {
namespace {

constexpr double kSide_m = 0.01, kSpeed_m_s = 0.02, kRate_hz = 30.0;
constexpr int kLinks = 40;  // of the plant's chain, on each side of the port

template <class Samples, class Get>
Eigen::Vector3d Mean(const Samples& samples, Get get) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& sample : samples) sum += get(sample.value);
  return sum / static_cast<double>(samples.size());
}

/// Of the recording's places of the wrist the one nearest to their mean, but where the mean itself
/// would do: a place the instrument was at.
Eigen::Vector3d MiddleWrist(const WristStream& wrist) {
  const Eigen::Vector3d mean = Mean(wrist.samples, [](const WristSample& s) { return s.p_RW; });
  Eigen::Vector3d nearest = wrist.samples.front().value.p_RW;
  for (const auto& sample : wrist.samples) {
    if ((sample.value.p_RW - mean).norm() < (nearest - mean).norm()) nearest = sample.value.p_RW;
  }
  return nearest;
}

/// Of the instrument about its axis: its y axis against R's, turned to the shaft without twist.
double RollOf(const WristStream& wrist, const Eigen::Vector3d& p_RW) {
  for (const auto& sample : wrist.samples) {
    if (sample.value.p_RW != p_RW || !sample.value.q_RW) continue;
    const Eigen::Matrix3d R_RW = sample.value.q_RW->toRotationMatrix();
    const Eigen::Matrix3d untwisted = RotationWithoutTwist(Eigen::Vector3d::UnitX(), R_RW.col(0));
    return std::atan2(untwisted.col(2).dot(R_RW.col(1)), untwisted.col(1).dot(R_RW.col(1)));
  }
  return 0.0;
}

/// As the simulation needs it: without samples. At the controller's rate or the sensor's own.
template <class Stream, class Samples>
std::optional<Stream> Empty(std::optional<Stream> stream, Samples Stream::*samples) {
  if (!stream || ((*stream).*samples).empty()) return {};
  ((*stream).*samples).clear();
  stream->rate_hz = kRate_hz;
  return stream;
}

/// An EM sensor of the simulation stands in R as it says.
std::optional<EmStream> EmptyEm(const std::optional<EmStream>& recorded) {
  auto em = Empty(recorded, &EmStream::samples);
  if (em) em->registration_noise_m = em->registration_noise_rad = 0.0;
  return em;
}

TipSensorSetup TipSensor(const Recording& recording, const Eigen::Vector3d& p_tip,
                         const Eigen::Vector3d& to_port) {
  TipSensorSetup tip;
  tip.rate_hz = kRate_hz;
  tip.line_of_sight = to_port;
  if (recording.cam0 && recording.cam0->has_T_RC) {
    tip.T_RC = recording.cam0->calibration.T_RC;
    const Eigen::Vector3d sight = p_tip - tip.T_RC.p;
    if (sight.norm() > 1e-6) tip.line_of_sight = sight.normalized();
  }
  if (!recording.vision0 || recording.vision0->tips.empty()) return tip;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int count = 0;
  for (const auto& sample : recording.vision0->tips) {
    if (sample.value.status != TipStatus::kOk) continue;
    covariance += sample.value.covariance_m2;
    ++count;
  }
  if (count == 0) return tip;
  const Eigen::Vector3d variances = SymmetricEigenvalues(covariance / count);
  tip.depth_noise_m = std::sqrt(std::max(0.0, variances[2]));
  tip.across_noise_m = std::sqrt(std::max(0.0, 0.5 * (variances[0] + variances[1])));
  tip.direction_noise_rad = recording.vision0->direction_noise_rad;
  return tip;
}

/// A square across the shaft, from one of its corners.
PathSetup Square(const Eigen::Vector3d& along) {
  PathSetup path;
  path.speed_m_s = kSpeed_m_s;
  path.settle_s = 0.2;
  const Eigen::Matrix<double, 3, 2> across = NormalBasis(along);
  const Eigen::Vector3d a = kSide_m * across.col(0), b = kSide_m * across.col(1);
  path.waypoints_m = {a, a + b, b, Eigen::Vector3d::Zero()};
  return path;
}

constexpr const char* kRegistration = "registration";  // of the recording's sensors, not of these

/// `model` with what the simulation knows of it; the effects it does not know go to `left_out`.
diagnosis::ExtendedModel Simulated(diagnosis::ExtendedModel model,
                                   std::vector<std::string>& left_out) {
  for (const diagnosis::Term& term : model.discovered)
    left_out.push_back(std::string("the term of ") + diagnosis::InfoOf(term.target).channel);
  model.discovered.clear();  // the plant does not have it
  for (auto* list : {&model.effects, &model.within_tolerance}) {
    std::erase_if(*list, [&](const diagnosis::EffectFit& fit) {
      const bool known = fit.effect == kRegistration || NeutralEffects().contains(fit.effect);
      if (!known) left_out.push_back(fit.effect);
      return !known;
    });
    for (diagnosis::EffectFit& fit : *list) {
      for (diagnosis::ReportedParameter& parameter : fit.parameters)
        if (parameter.name.starts_with("overtone_"))
          parameter.value.assign(parameter.value.size(), 0.0);
    }
  }
  return model;
}

/// What the simulation has a parameter for: it turns a pose by the focal length as it must.
EffectValues ValuesOf(const diagnosis::ExtendedModel& model) {
  EffectValues values;
  for (const auto* list : {&model.effects, &model.within_tolerance}) {
    for (const diagnosis::EffectFit& fit : *list) {
      if (fit.effect == kRegistration) continue;
      const EffectParameters& known = NeutralEffects().at(fit.effect);
      for (const diagnosis::ReportedParameter& parameter : fit.parameters)
        if (known.contains(parameter.name)) values[fit.effect][parameter.name] = parameter.value;
    }
  }
  return values;
}

LoopSetup MakeSetup(const Recording& recording, const diagnosis::ExtendedModel& model) {
  LoopSetup setup;
  setup.base.instrument = recording.instrument;
  setup.base.p_RP = recording.p_RP;
  setup.base.gravity_m_s2 = recording.gravity_m_s2;
  if (recording.cam0) {
    setup.base.cam0.emplace();
    setup.base.cam0->calibration = recording.cam0->calibration;
    setup.base.cam0->has_T_RC = recording.cam0->has_T_RC;
  }
  setup.p_RW_start = MiddleWrist(*recording.wrist0);
  const Eigen::Vector3d to_port = (recording.p_RP - setup.p_RW_start).normalized();
  const Eigen::Vector3d p_tip = setup.p_RW_start + recording.instrument.length_m * to_port;

  PlantSetup& plant = setup.plant;
  plant.instrument = recording.instrument;
  plant.p_RP = recording.p_RP;
  plant.gravity_m_s2 = recording.gravity_m_s2;
  plant.weight_N_m = recording.instrument.mass_per_length_kg_m * recording.gravity_m_s2;
  plant.roll_rad = RollOf(*recording.wrist0, setup.p_RW_start);
  if (recording.load0 && !recording.load0->f_tip_N.empty()) {
    plant.load.constant_N =
        Mean(recording.load0->f_tip_N, [](const Eigen::Vector3d& f) { return f; });
  }
  const InstrumentEffects effects = EffectsOfWholeMass(ValuesOf(model), recording.instrument);
  plant.effects = effects.plant;
  setup.plant_options = {kLinks, kLinks};
  setup.sensor_effects = effects.sensors;
  setup.sensor_effects.em_centre_m = model.centre_m;

  setup.sensors.wrist = Empty(recording.wrist0, &WristStream::samples);
  setup.sensors.em0 = EmptyEm(recording.em0);
  setup.sensors.em1 = EmptyEm(recording.em1);
  setup.sensors.strain = Empty(recording.strain0, &StrainStream::moments_Nm);
  setup.sensors.load = Empty(recording.load0, &LoadStream::f_tip_N);
  setup.sensors.tip = TipSensor(recording, p_tip, to_port);
  setup.update_rate_hz = kRate_hz;
  setup.path = Square(to_port);
  return setup;
}

PathDeviation Run(const LoopSetup& setup) {
  const LoopResult result = RunClosedLoop(setup, nullptr);
  return {result.max_deviation_m, result.rms_deviation_m};
}

}  // namespace

ClosedLoopGain MeasureClosedLoopGain(const Recording& recording,
                                     const diagnosis::ExtendedModel& model) {
  if (!recording.wrist0 || recording.wrist0->samples.empty()) return {};
  std::vector<std::string> left_out;
  diagnosis::ExtendedModel now = Simulated(model, left_out);
  const LoopSetup common = MakeSetup(recording, now);
  now.start_ns = kSimulationStart_ns;  // the simulated run's clock starts with it
  ClosedLoopGain gain;
  if (!left_out.empty()) {
    gain.warning = fmt::format("closed loop: {} left out, which the simulation does not know",
                               fmt::join(left_out, ", "));
  }
  for (const ControllerKind kind : {ControllerKind::kRodCalculate, ControllerKind::kRodTrack})
    gain.controllers.push_back({kind, true, {}, {}});
  std::vector<char> ran(2 * gain.controllers.size(), 1);  // one for each run: no two threads' own
  tbb::parallel_for(std::size_t(0), ran.size(), [&](std::size_t i) {
    ControllerGain& controller = gain.controllers[i / 2];
    const bool knows = i % 2 == 1;
    LoopSetup setup = common;
    setup.controller.kind = controller.kind;
    if (knows)
      setup.model = [&] {
        return std::make_unique<diagnosis::ExtendedInstrument>(now, common.base);
      };
    try {
      (knows ? controller.extended : controller.base) = Run(setup);
    } catch (const std::runtime_error&) {  // no equilibrium at the start or on the way
      ran[i] = 0;
    }
  });
  for (std::size_t c = 0; c < gain.controllers.size(); ++c)
    gain.controllers[c].ran = ran[2 * c] != 0 && ran[2 * c + 1] != 0;
  return gain;
}

}  // namespace flextip::simulation
