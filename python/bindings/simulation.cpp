// Closed loops of plant, sensors, vision and controllers.
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"
#include "python/bindings/truth.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip::python {
namespace {

using diagnosis::ExtendedModel;
using simulation::LoopResult;
using simulation::LoopUpdate;
using simulation::Scenario;

/// What flextip simulate writes, as an object.
struct Simulation {
  std::map<std::string, LoopResult> runs;
  std::vector<std::string> warnings;
};
using SaveFrame = std::function<void(const std::string&, TimeNs, const Image&)>;

/// Sets `scenario.controllers` to those that are asked for.
void ChooseControllers(const std::vector<std::string>& names, Scenario& scenario) {
  scenario.controllers.clear();
  for (const std::string& name : names) {
    const auto kind = ControllerKindNamed(name);
    if (!kind) throw InputError("controllers: found " + name + ", expected names as rod-track");
    scenario.controllers.push_back(*kind);
  }
}

/// The stages of the command simulate, in its order, a controller after the other.
Simulation SimulateWhole(const std::filesystem::path& file,
                         const std::optional<ExtendedModel>& model, bool render,
                         const std::optional<std::vector<std::string>>& controllers,
                         const SaveFrame& save) {
  Scenario scenario = simulation::ReadScenario(file);
  simulation::RequireRunnable(scenario, file, render);
  if (controllers) ChooseControllers(*controllers, scenario);
  simulation::RequireShort(scenario, file);
  if (model) simulation::UseModel(*model, scenario);
  std::optional<simulation::Laparoscope> laparoscope;
  if (render) laparoscope.emplace(simulation::LaparoscopeOf(scenario));
  Interruption interruption;
  Simulation result{{}, scenario.warnings};
  for (const ControllerKind kind : scenario.controllers) {
    const auto save_frame = [&](TimeNs t_ns, const Image& image) { save(Name(kind), t_ns, image); };
    result.runs[Name(kind)] =
        simulation::RunController(scenario, kind, laparoscope ? &*laparoscope : nullptr, save_frame,
                                  [&](int, int) { interruption.Check(); });
  }
  return result;
}

Simulation Simulate(const std::filesystem::path& scenario, std::optional<ExtendedModel> model,
                    bool render, std::optional<std::vector<std::string>> controllers,
                    const std::optional<py::function>& on_frame) {
  const SaveFrame save = [&on_frame](const std::string& controller, TimeNs t_ns,
                                     const Image& image) {
    if (!on_frame) return;
    const py::gil_scoped_acquire gil;
    (*on_frame)(controller, t_ns, ImageArray(image));
  };
  return WithoutGil([&] { return SimulateWhole(scenario, model, render, controllers, save); });
}

void AddRun(py::module_& module) {
  py::class_<LoopResult>(module, "Run", "A controller's run, in R.")
      .def_readonly("recording", &LoopResult::recording, "What the sensors recorded.")
      .def_property_readonly(
          "truth", [](const LoopResult& r) { return Truth{r.truth}; },
          "The true tip and wrist, for scoring.")
      .def_property_readonly(
          "t_ns",
          [](const LoopResult& r) {
            return Column<TimeNs>(r.updates, [](const LoopUpdate& u) { return u.t_ns; });
          },
          "Times of the controller's updates, (N,) int64, ns.")
      .def_property_readonly(
          "p_RE_desired",
          [](const LoopResult& r) {
            return Table(r.updates, {3},
                         [](const LoopUpdate& u, double* row) { Put(u.p_RE_desired, row); });
          },
          "Wished place of the tip, as the fixtures left it, (N, 3), m.")
      .def_property_readonly(
          "p_RE",
          [](const LoopResult& r) {
            return Table(r.updates, {3},
                         [](const LoopUpdate& u, double* row) { Put(u.p_RE, row); });
          },
          "True place of the tip, (N, 3), m.")
      .def_property_readonly(
          "deviation_m",
          [](const LoopResult& r) {
            return Column(r.updates, [](const LoopUpdate& u) { return u.deviation_m; });
          },
          "Distance of the true tip from the path, (N,), m.")
      .def_property_readonly(
          "status",
          [](const LoopResult& r) {
            return TextColumn(r.updates, [](const LoopUpdate& u) { return Name(u.status); });
          },
          "The controller's status, as Command.status, (N,).")
      .def_readonly("max_deviation_m", &LoopResult::max_deviation_m, "Largest deviation (m).")
      .def_readonly("rms_deviation_m", &LoopResult::rms_deviation_m, "RMS deviation (m).")
      .def_readonly("final_error_m", &LoopResult::final_error_m,
                    "Distance of the true tip from the last waypoint (m).")
      .def_readonly("final_direction_error_rad", &LoopResult::final_direction_error_rad,
                    "Error of its direction, where the path has directions (rad).")
      .def_readonly("control_statuses", &LoopResult::control_statuses, "Updates by status.")
      .def_readonly("tip_statuses", &LoopResult::tip_statuses, "Tips by status.")
      .def_readonly("fixture_statuses", &LoopResult::fixture_statuses,
                    "Updates by the fixtures' status; empty without fixtures.")
      .def_readonly("steps_limited", &LoopResult::steps_limited, "Steps that were shortened.")
      .def_readonly("steps_damped", &LoopResult::steps_damped, "Steps near a singular Jacobian.");
}

}  // namespace

void AddSimulation(py::module_& module) {
  AddRun(module);
  py::class_<Simulation>(module, "Simulation", "The runs of a scenario.")
      .def_readonly("runs", &Simulation::runs, "Runs by the controller's name: {name: Run}.")
      .def_readonly("warnings", &Simulation::warnings, "What to be careful about.");
  module.def("simulate", &Simulate, py::arg("scenario"), py::kw_only(),
             py::arg("model") = std::nullopt, py::arg("render") = false,
             py::arg("controllers") = std::nullopt, py::arg("on_frame") = std::nullopt,
             R"doc(Runs a scenario's closed loops, a controller after the other.

scenario: file (docs/scenarios.md). model: of which estimator and controllers know, the simulated
instrument does not. render: render laparoscope frames and run the loop on what vision sees in them.
controllers: names as "rod-track"; None: the scenario's. on_frame: called with the controller's
name, the time (ns) and the picture, uint8 (H, W, 3: blue, green, red) or (H, W).

Raises InputError for the scenario, WorkError where the instrument loses its equilibrium.)doc");
}

}  // namespace flextip::python
