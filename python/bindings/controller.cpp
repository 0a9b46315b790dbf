// Controller: a control cycle, from sensor samples to the wrist's command.
#include "control/controller.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <variant>

#include "core/error.h"
#include "diagnosis/model/extended_instrument.h"
#include "pipeline/instrument_controller.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"
#include "python/bindings/tracker.h"
#include "task/mesh_file.h"

namespace flextip::python {
namespace {

using diagnosis::ExtendedModel;
using SharedController = Shared<InstrumentController>;
/// A Fixture whose first kind has a default, as pybind11 needs it.
using AnyFixture = std::variant<ForbiddenHalfSpace, ForbiddenSphere, PathGuidance, ForbiddenMesh>;

ControllerKind KindNamed(const std::string& name) {
  const auto kind = ControllerKindNamed(name);
  if (kind) return *kind;
  std::string names;
  for (int i = 0; i < kControllerKinds; ++i) {
    names += (i > 0 ? ", " : "") + std::string(Name(static_cast<ControllerKind>(i)));
  }
  throw InputError(fmt::format("kind: found {}, expected one of {}", name, names));
}

BeamLoadLaw LoadLawNamed(const std::string& name) {
  if (name == "tip_force") return BeamLoadLaw::kTipForce;
  if (name == "port_force") return BeamLoadLaw::kPortForce;
  throw InputError("beam_load_law: found " + name + ", expected tip_force or port_force");
}

DirectionPriority PriorityNamed(const std::string& name) {
  if (name == "weighted") return DirectionPriority::kWeighted;
  if (name == "position_first") return DirectionPriority::kPositionFirst;
  throw InputError("priority: found " + name + ", expected weighted or position_first");
}

void AddFixtures(py::module_& module) {
  py::class_<ForbiddenHalfSpace>(
      module, "HalfSpace", "A virtual fixture: the tip stays out of everything behind a plane.")
      .def(py::init([](const Eigen::Vector3d& p_plane, const Eigen::Vector3d& normal) {
             RequireFinite("p_plane", p_plane);
             Positive("length of normal", normal.norm());
             return ForbiddenHalfSpace{p_plane, normal.normalized()};
           }),
           py::arg("p_plane"), py::arg("normal"),
           "p_plane: a place on it in R, (3,), m. normal: out of the forbidden side, any length.");
  py::class_<ForbiddenSphere>(module, "Sphere",
                              "A virtual fixture: the tip stays out of a sphere, or in it.")
      .def(py::init([](const Eigen::Vector3d& p_centre, double radius_m, bool forbidden_outside) {
             RequireFinite("p_centre", p_centre);
             return ForbiddenSphere{p_centre, Positive("radius_m", radius_m), forbidden_outside};
           }),
           py::arg("p_centre"), py::arg("radius_m"), py::arg("forbidden_outside") = false,
           "p_centre: in R, (3,), m. forbidden_outside: the tip stays in it.");
  py::class_<PathGuidance>(module, "PathGuidance",
                           "A virtual fixture: a polyline that draws the tip to it.")
      .def(py::init([](const Doubles& points, double compliance, double free_radius_m) {
             if (points.ndim() != 2) throw InputError("points: expected the shape (N, 3)");
             const auto count = static_cast<std::size_t>(points.shape(0));
             const Rows rows("points", points, count, 3);
             std::vector<Eigen::Vector3d> line;
             for (std::size_t i = 0; i < count; ++i) line.push_back(rows.Vector3(i));
             return PathGuidance(std::move(line), compliance, free_radius_m);
           }),
           py::arg("points"), py::arg("compliance") = 0.0, py::arg("free_radius_m") = 0.0,
           "points: in R, (N, 3), m. compliance: the part of a deviation that is let through, 0 to "
           "1. Within free_radius_m nothing is changed. Raises InputError.")
      .def_property_readonly("length_m", &PathGuidance::Length, "Its length (m).");
  py::class_<ForbiddenMesh>(module, "Mesh",
                            "A virtual fixture: the tip stays out of a closed mesh, or in it.")
      .def(
          py::init([](const std::filesystem::path& file, bool forbidden_outside) {
            return ForbiddenMesh(ReadMesh(file), forbidden_outside);
          }),
          py::arg("file"), py::arg("forbidden_outside") = false,
          "file: Wavefront OBJ, m, in R, faces anticlockwise seen from outside. Raises InputError.")
      .def_property_readonly("triangles", &ForbiddenMesh::TriangleCount, "Number of triangles.");
}

void AddDirection(py::module_& module) {
  const DirectionOptions usual;
  py::class_<DirectionOptions>(module, "DirectionOptions",
                               "How the tip's direction is controlled beside its place.")
      .def(py::init([](const std::string& priority, double position_tolerance_m,
                       double direction_tolerance_rad) {
             DirectionOptions options;
             options.priority = PriorityNamed(priority);
             options.position_tolerance_m = Positive("position_tolerance_m", position_tolerance_m);
             options.direction_tolerance_rad =
                 Positive("direction_tolerance_rad", direction_tolerance_rad);
             return options;
           }),
           py::kw_only(), py::arg("priority") = "weighted",
           py::arg("position_tolerance_m") = usual.position_tolerance_m,
           py::arg("direction_tolerance_rad") = usual.direction_tolerance_rad,
           "priority: \"weighted\" (an error of position_tolerance_m weighs as much as one of "
           "direction_tolerance_rad) or \"position_first\".");
}

void AddCommandClass(py::module_& module) {
  const auto if_wrist = [](auto part) {
    return [part](const ControllerCommand& c) {
      const bool there = c.status != ControlStatus::kNoWrist;
      return there ? std::optional(Eigen::Vector3d(c.*part)) : std::nullopt;
    };
  };
  py::class_<ControllerCommand>(module, "Command", "The result of a control cycle, in R.")
      .def_readonly("t_ns", &ControllerCommand::t_ns, "Time of the cycle (ns).")
      .def_property_readonly(
          "status", [](const ControllerCommand& c) { return Name(c.status); },
          "\"ok\", \"straight_instead\" (flexion not observable now); or why the wrist holds "
          "still: "
          "\"bad_input\", \"no_tip\", \"no_model\", \"no_goal\"; \"no_wrist\": there is no "
          "command.")
      .def_property_readonly("p_RW_command", if_wrist(&ControllerCommand::p_RW_command),
                             "Where the wrist is to go, (3,), m; None with \"no_wrist\".")
      .def_property_readonly("p_RE_used", if_wrist(&ControllerCommand::p_RE_used),
                             "The tip the step started from, (3,), m; None with \"no_wrist\".")
      .def_property_readonly(
          "p_RE_measured",
          [](const ControllerCommand& c) { return std::optional(c.p_RE_measured); },
          "The tip as the controller was given it, (3,), m; None where it was not.")
      .def_readonly("step_limited", &ControllerCommand::step_limited,
                    "The step was shortened to max_step_m, or to keep its distance from the port.")
      .def_readonly("damped", &ControllerCommand::damped, "The Jacobian was near singular.")
      .def_property_readonly(
          "estimate", [](const ControllerCommand& c) { return ShaftEstimate(c.estimate); },
          "Load, port and shape of this cycle.")
      .def_property_readonly(
          "fixture_status", [](const ControllerCommand& c) { return Name(c.goal.status); },
          "What the fixtures did: \"free\", \"moved\", \"not_clear\" or \"bad_input\".")
      .def_property_readonly(
          "p_RE_desired",
          [](const ControllerCommand& c) { return Eigen::Vector3d(c.goal.p_RE_desired); },
          "The wish, kept by the fixtures, (3,), m.");
}

std::unique_ptr<SharedController> MakeController(
    const Recording& recording, const std::string& kind, double gain, double max_step_m,
    const std::string& beam_load_law, double max_tissue_gain, double min_singular_value,
    double port_prior_m, int window_samples, const std::vector<AnyFixture>& fixtures,
    double margin_m, double margin_sd, const std::optional<DirectionOptions>& direction,
    const Eigen::Vector3d& direction_free_axis, bool em_is_tip, bool straight_at_registered_port,
    const std::optional<ExtendedModel>& model, const std::optional<TrackerOptions>& tracker,
    double rate_hz, double tip_time_sd_s, double em0_time_sd_s, bool em0_is_late) {
  InstrumentControllerOptions options;
  options.rate_hz = NotNegative("rate_hz", rate_hz);
  options.late.tip_time_sd_s = NotNegative("tip_time_sd_s", tip_time_sd_s);
  options.late.em0_time_sd_s = NotNegative("em0_time_sd_s", em0_time_sd_s);
  options.late.carry_em0 = em0_is_late || em0_time_sd_s > 0.0;
  options.estimator =
      EstimatorOptionsFor(recording.instrument, recording.p_RP, recording.gravity_m_s2,
                          Positive("port_prior_m", port_prior_m));
  if (window_samples != 0 && (window_samples < 2 || window_samples > 1000)) {
    throw InputError(
        fmt::format("window_samples: found {}, expected 0 or 2 to 1000", window_samples));
  }
  options.window_samples = window_samples;
  options.control = {.kind = KindNamed(kind),
                     .beam_load_law = LoadLawNamed(beam_load_law),
                     .gain = Positive("gain", gain),
                     .max_step_m = Positive("max_step_m", max_step_m),
                     .max_tissue_gain = Positive("max_tissue_gain", max_tissue_gain),
                     .min_singular_value = NotNegative("min_singular_value", min_singular_value)};
  options.direction = direction;
  if (options.direction) {
    options.direction->gain = gain;
    options.direction->max_step_m = max_step_m;
    options.direction->max_tissue_gain = max_tissue_gain;
    options.direction->min_singular_value = min_singular_value;
  }
  options.direction_free_axis = direction_free_axis;
  for (const AnyFixture& fixture : fixtures) {
    std::visit([&](const auto& one) { options.fixtures.list.emplace_back(one); }, fixture);
  }
  options.fixtures.margin_m = NotNegative("margin_m", margin_m);
  options.fixtures.margin_sd = NotNegative("margin_sd", margin_sd);
  options.em_is_tip = em_is_tip;
  options.straight_at_registered_port = straight_at_registered_port;
  std::unique_ptr<InstrumentModel> found;
  if (model) found = std::make_unique<diagnosis::ExtendedInstrument>(*model, recording);
  std::unique_ptr<InstrumentTracker> eyes;
  if (tracker) {
    eyes = std::make_unique<InstrumentTracker>(TrackerSetupFor(recording, *tracker, true));
  }
  return std::make_unique<SharedController>(options, std::move(found), std::move(eyes));
}

ControllerCommand Step(SharedController& controller, TimeNs t_ns, const SensorReadings& readings,
                       const std::optional<Eigen::Vector3d>& p_RE_desired,
                       const std::optional<Eigen::Vector3d>& d_RE_desired,
                       const std::vector<std::optional<py::array>>& pictures,
                       std::optional<TimeNs> pictures_t_ns) {
  const std::vector<Image> images = PicturesFrom(pictures);
  const std::vector<const Image*> pointers = PointersTo(images);
  ControllerInputs inputs;
  inputs.t_ns = t_ns;
  inputs.sensors = readings;
  inputs.pictures = pointers;
  inputs.pictures_t_ns = pictures_t_ns.value_or(t_ns);
  inputs.p_RE_desired = p_RE_desired;
  inputs.d_RE_desired = d_RE_desired;
  return controller.Use([&](InstrumentController& c) { return c.Step(inputs); });
}

}  // namespace

void AddController(py::module_& module) {
  AddFixtures(module);
  AddDirection(module);
  AddCommandClass(module);
  const ControllerOptions usual;
  py::class_<SharedController>(module, "Controller",
                               "Moves the tip to where it is wished, a cycle at a time. The same "
                               "inputs give the same commands. Threads that share it take turns.")
      .def(py::init(&MakeController), py::arg("recording"), py::kw_only(),
           py::arg("kind") = Name(usual.kind), py::arg("gain") = usual.gain,
           py::arg("max_step_m") = usual.max_step_m, py::arg("beam_load_law") = "tip_force",
           py::arg("max_tissue_gain") = usual.max_tissue_gain,
           py::arg("min_singular_value") = usual.min_singular_value,
           py::arg("port_prior_m") = kPortRegistration_m, py::arg("window_samples") = 0,
           py::arg("fixtures") = std::vector<AnyFixture>(), py::arg("margin_m") = 0.0,
           py::arg("margin_sd") = 0.0, py::arg("direction") = std::nullopt,
           py::arg("direction_free_axis") = Eigen::Vector3d::Zero().eval(),
           py::arg("em_is_tip") = false, py::arg("straight_at_registered_port") = false,
           py::arg("model") = std::nullopt, py::arg("tracker") = std::nullopt,
           py::arg("rate_hz") = 0.0, py::arg("tip_time_sd_s") = 0.0, py::arg("em0_time_sd_s") = 0.0,
           py::arg("em0_is_late") = false,
           R"doc(recording: instrument, port and gravity (cameras and collar, too, with tracker);
its samples are not read.

kind: "straight-", "flex-" or "rod-", with "calculate" (the tip by the model) or "track" (the tip as
measured). gain: part of the error that a step takes away. max_step_m: bound on the wrist's step.
fixtures: HalfSpace, Sphere, PathGuidance, Mesh; margin_m and margin_sd (standard deviations of the
tip) are kept from forbidden regions. direction: the tip's direction counts, too; rod kinds only.
em_is_tip: without vision em0, carried to the tip, is the tip. model: what a diagnosis found.
tracker: step() sees the tip in pictures.

A sample's time is when it was measured, its latency taken off. tip_time_sd_s and em0_time_sd_s:
standard deviations of these times; they enter the covariance by the speed, and with rate_hz, cycles
a second, they bound the gain (0: the gain stays as it is). em0_is_late: em0 is carried on to the
wrist's time as the tip is; without it em0 counts as simultaneous with the wrist.

Raises InputError.)doc")
      .def("step", &Step, py::arg("t_ns"), py::arg("readings"),
           py::arg("p_RE_desired") = std::nullopt, py::arg("d_RE_desired") = std::nullopt,
           py::kw_only(), py::arg("pictures") = std::vector<std::optional<py::array>>(),
           py::arg("pictures_t_ns") = std::nullopt,
           R"doc(Runs a cycle.

t_ns: not before the last cycle. readings: the newest sample of each sensor, at its own time; a late
tip, and the last one until 0.12 s after its first cycle, is carried on to the wrist's time.
p_RE_desired: the tip's wished place in R, (3,), m; None: only watches. d_RE_desired: its wished
direction, any length. pictures: one a camera, as Tracker.track takes them; pictures_t_ns: their
time, the cycle's where None.

Returns a Command. Raises InputError for pictures of the wrong type or size.)doc");
}

}  // namespace flextip::python
