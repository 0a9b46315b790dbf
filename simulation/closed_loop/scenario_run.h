// The runs of a scenario, a controller each.
#pragma once

#include <filesystem>
#include <functional>

#include "diagnosis/model/extended_model.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::simulation {

/// Throws InputError naming `file` where the scenario cannot run rendered (no camera, an effect
/// that pictures do not show), or not rendered (no sensor of the tip).
void RequireRunnable(const Scenario& scenario, const std::filesystem::path& file, bool rendered);

inline constexpr double kMostSamples = 5e6;

/// Throws InputError naming `file` where the runs of all controllers would take more than
/// kMostSamples samples of sensors and updates together: they are held in memory.
void RequireShort(const Scenario& scenario, const std::filesystem::path& file);

/// Lets estimator and controllers of all runs know of `model`. The simulated instrument does not.
void UseModel(const diagnosis::ExtendedModel& model, Scenario& scenario);

/// Returns the laparoscope of a scenario with a camera: the true camera, before the true collar.
Laparoscope LaparoscopeOf(const Scenario& scenario);

/// Runs the closed loop under `kind`; with a `laparoscope` on rendered frames, which `save` is
/// given. `progress`: updates done, of how many. Throws WorkError where the instrument loses its
/// equilibrium. Several threads may call it for one scenario.
LoopResult RunController(const Scenario& scenario, ControllerKind kind,
                         const Laparoscope* laparoscope,
                         const std::function<void(TimeNs, const Image&)>& save = {},
                         const std::function<void(int, int)>& progress = {});

}  // namespace flextip::simulation
