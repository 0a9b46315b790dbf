#include "simulation/closed_loop/scenario_run.h"

#include <fmt/format.h>

#include <memory>

#include "core/error.h"
#include "diagnosis/model/extended_instrument.h"
#include "simulation/sensors/camera_view.h"
#include "simulation/sensors/sensors.h"

namespace flextip::simulation {

void RequireRunnable(const Scenario& scenario, const std::filesystem::path& file, bool rendered) {
  const LoopSetup& loop = scenario.loop;
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: {}", file.string(), why));
  };
  if (!rendered) {
    if (!loop.sensors.tip) refuse("not rendered, the sensors need a section tip");
    return;
  }
  if (!scenario.has_camera) refuse("rendered, the scenario needs a section camera");
  if (loop.plant.effects.tip_compliance_m_N != 0.0)
    refuse("effects: tip_compliance does not show in rendered frames: run it not rendered");
}

void RequireShort(const Scenario& scenario, const std::filesystem::path& file) {
  const LoopSetup& loop = scenario.loop;
  const double seconds = PathSeconds(loop);
  const double rate_hz = SamplesPerSecond(loop.sensors) + loop.update_rate_hz;
  const double samples = seconds * rate_hz * static_cast<double>(scenario.controllers.size());
  if (samples <= kMostSamples) return;
  throw InputError::At(
      file.string(), 0,
      fmt::format("asks for {:.2g} samples ({:.3g} s, {:.3g} samples a second, {} controllers), "
                  "expected at most {:g}: a shorter path or lower rates",
                  samples, seconds, rate_hz, scenario.controllers.size(), kMostSamples));
}

void UseModel(const diagnosis::ExtendedModel& model, Scenario& scenario) {
  scenario.loop.model = [model, base = scenario.loop.base] {
    return std::make_unique<diagnosis::ExtendedInstrument>(model, base);
  };
}

Laparoscope LaparoscopeOf(const Scenario& scenario) {
  const LoopSetup& loop = scenario.loop;
  const SensorEffects& effects = loop.sensor_effects;
  const bool drifts = !effects.camera_drift_rad_s.isZero(0) || !effects.camera_drift_m_s.isZero(0);
  if (drifts || effects.camera_clock_rate != 0.0) {
    throw InputError(
        "effects camera_drift and camera_clock are not rendered: expected a run without --render");
  }
  return Laparoscope(TrueCamera(loop.base.cam0->calibration, effects),
                     TrueCollar(*loop.base.tags0, effects), scenario.laparoscope);
}

LoopResult RunController(const Scenario& scenario, ControllerKind kind,
                         const Laparoscope* laparoscope,
                         const std::function<void(TimeNs, const Image&)>& save,
                         const std::function<void(int, int)>& progress) {
  LoopSetup setup = scenario.loop;
  setup.controller.kind = kind;
  if (laparoscope == nullptr) return RunClosedLoop(setup, nullptr, progress);
  const LoopCamera camera{*laparoscope, scenario.tracker, save};
  return RunClosedLoop(setup, &camera, progress);
}

}  // namespace flextip::simulation
