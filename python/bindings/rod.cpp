// The models of the shaft: shapes, the exact rod and its Jacobian, the thesis's beam and its own.
#include "kinematics/rod.h"

#include <fmt/format.h>

#include <map>

#include "core/error.h"
#include "kinematics/beam.h"
#include "kinematics/shaft_shape.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"

namespace flextip::python {
namespace {

template <class T>
T NamedOf(const char* what, const std::map<std::string, T>& known, const std::string& name) {
  const auto found = known.find(name);
  if (found != known.end()) return found->second;
  std::string names;
  for (const auto& [text, value] : known) names += (names.empty() ? "" : ", ") + text;
  throw InputError(fmt::format("{}: found {}, expected one of {}", what, name, names));
}

RodProblem MakeProblem(double length_m, double bending_stiffness_Nm2,
                       const Eigen::Vector3d& p_wrist, const Eigen::Vector3d& p_port,
                       const Eigen::Vector3d& f_tip, const Eigen::Vector3d& q_weight) {
  return {.length_m = length_m,
          .bending_stiffness_Nm2 = bending_stiffness_Nm2,
          .p_wrist = p_wrist,
          .p_port = p_port,
          .f_tip = f_tip,
          .q_weight = q_weight};
}

/// Gives `part(state)` where the state is usable, else None.
template <class State, class Part>
auto IfUsable(Part part) {
  return [part](const State& state) {
    using Value = std::decay_t<decltype(part(state))>;
    return state.IsUsable() ? std::optional<Value>(part(state)) : std::nullopt;
  };
}

void AddShape(py::module_& module) {
  const auto solve = [](double length_m, double bending_stiffness_Nm2,
                        const Eigen::Vector3d& p_wrist, const Eigen::Vector3d& p_port,
                        const Eigen::Vector3d& f_tip, const Eigen::Vector3d& q_weight,
                        const std::string& model) {
    const auto kind = NamedOf<ShapeModel>("model",
                                          {{"rod", ShapeModel::kRod},
                                           {"beam", ShapeModel::kBeam},
                                           {"straight", ShapeModel::kStraight}},
                                          model);
    const RodProblem problem =
        MakeProblem(length_m, bending_stiffness_Nm2, p_wrist, p_port, f_tip, q_weight);
    return WithoutGil([&] { return SolveShape(problem, kind); });
  };
  py::class_<Shape>(module, "Shape",
                    "A shape of the shaft, in R. Where the status is not \"ok\" all else is None.")
      .def_readonly("status", &Shape::status, "\"ok\", or why there is no shape.")
      .def_property_readonly("p_tip", IfUsable<Shape>([](const Shape& s) { return s.p_tip; }),
                             "Tip, (3,), m.")
      .def_property_readonly("t_wrist", IfUsable<Shape>([](const Shape& s) { return s.t_wrist; }),
                             "Unit tangent at the wrist, (3,).")
      .def_property_readonly("t_tip", IfUsable<Shape>([](const Shape& s) { return s.t_tip; }),
                             "Unit tangent at the tip, (3,).")
      .def_property_readonly("s_port_m", IfUsable<Shape>([](const Shape& s) { return s.s_port_m; }),
                             "The port, from the wrist along the shaft (m).")
      .def_property_readonly("f_port", IfUsable<Shape>([](const Shape& s) { return s.f_port; }),
                             "Force of the port on the shaft, (3,), N.")
      .def_property_readonly("f_wrist", IfUsable<Shape>([](const Shape& s) { return s.f_wrist; }),
                             "Force of the wrist on the shaft, (3,), N.")
      .def_property_readonly(
          "points", IfUsable<Shape>([](const Shape& s) {
            return Table(s.points, {3}, [](const Eigen::Vector3d& p, double* row) { Put(p, row); });
          }),
          "The centre line from wrist to tip, (N, 3), m.");
  module.def("solve_shape", solve, py::arg("length_m"), py::arg("bending_stiffness_Nm2"),
             py::arg("p_wrist"), py::arg("p_port"), py::arg("f_tip"),
             py::arg("q_weight") = Eigen::Vector3d::Zero().eval(), py::arg("model") = "rod",
             R"doc(Solves the shaft's equilibrium, as flextip shape.

p_wrist, p_port: in R, (3,), m. f_tip: force on the tip, (3,), N. q_weight: weight per length, (3,),
N/m. model: "rod" (exact), "beam" (the thesis's) or "straight". A problem without an equilibrium is
a status. Raises InputError for an unknown model.)doc");
}

void AddSection(py::module_& module) {
  constexpr const char* kOrder = "by wrist, port and tip force, (3, 9).";
  py::class_<RodSection>(module, "RodSection", "The rod at a place along it, in R.")
      .def_readonly("s_m", &RodSection::s_m, "From the wrist along the shaft (m).")
      .def_property_readonly(
          "p", [](const RodSection& s) { return Eigen::Vector3d(s.p); }, "Position, (3,), m.")
      .def_property_readonly(
          "t", [](const RodSection& s) { return Eigen::Vector3d(s.t); }, "Unit tangent, (3,).")
      .def_property_readonly(
          "m", [](const RodSection& s) { return Eigen::Vector3d(s.m); },
          "Moment of the part beyond on the part before, (3,), Nm.")
      .def_property_readonly(
          "dp", [](const RodSection& s) { return RodDerivative(s.dp); },
          (std::string("Derivative of p ") + kOrder).c_str())
      .def_property_readonly(
          "dt", [](const RodSection& s) { return RodDerivative(s.dt); },
          (std::string("Derivative of t ") + kOrder).c_str())
      .def_property_readonly(
          "dm", [](const RodSection& s) { return RodDerivative(s.dm); },
          (std::string("Derivative of m ") + kOrder).c_str());
}

void AddRodState(py::module_& module) {
  py::class_<RodState>(module, "RodState",
                       "An equilibrium of the exact rod, in R. Where the status is not \"ok\" all "
                       "else is None.")
      .def_property_readonly(
          "status", [](const RodState& s) { return Name(s.status); },
          "\"ok\", or why there is no equilibrium.")
      .def_property_readonly("wrist", IfUsable<RodState>([](const RodState& s) { return s.wrist; }),
                             "The rod at the wrist.")
      .def_property_readonly("tip", IfUsable<RodState>([](const RodState& s) { return s.tip; }),
                             "The rod at the tip.")
      .def_property_readonly("s_port_m",
                             IfUsable<RodState>([](const RodState& s) { return s.s_port_m; }),
                             "The port, from the wrist along the shaft (m).")
      .def_property_readonly("t_port",
                             IfUsable<RodState>([](const RodState& s) { return s.t_port; }),
                             "Unit tangent at the port, (3,).")
      .def_property_readonly("f_port",
                             IfUsable<RodState>([](const RodState& s) { return s.f_port; }),
                             "Force of the port on the shaft, (3,), N.")
      .def_property_readonly("f_wrist",
                             IfUsable<RodState>([](const RodState& s) { return s.f_wrist; }),
                             "Force of the wrist on the shaft, (3,), N.")
      .def_property_readonly(
          "J_tip_wrist",
          IfUsable<RodState>([](const RodState& s) { return Eigen::Matrix3d(s.J_tip_wrist()); }),
          "Jacobian of the flexion model: d tip / d wrist, (3, 3), with the tip force constant.")
      .def(
          "jacobian",
          [](const RodState& s, const Eigen::Matrix3d& tissue) {
            return s.IsUsable() ? std::optional<Eigen::Matrix3d>(s.J_tip_wrist(tissue))
                                : std::nullopt;
          },
          py::arg("tissue_stiffness_N_m"),
          "Returns d tip / d wrist, (3, 3), where the load follows the tip by df_tip/dp_tip, (3, "
          "3), "
          "N/m; negative definite for tissue that pushes back.");
}

/// The solver and what its last equilibrium is of.
struct Rod {
  double length_m = 0.0, bending_stiffness_Nm2 = 0.0;
  Eigen::Vector3d q_weight = Eigen::Vector3d::Zero();
  RodSolver solver = {};
  bool solved = false;

  RodState Solve(const Eigen::Vector3d& p_wrist, const Eigen::Vector3d& p_port,
                 const Eigen::Vector3d& f_tip) {
    const RodState state = solver.Solve(
        MakeProblem(length_m, bending_stiffness_Nm2, p_wrist, p_port, f_tip, q_weight));
    solved = state.IsUsable();
    return state;
  }
  RodSection Section(double s_m) const {
    if (!solved) throw InputError("section: no rod was solved, expected solve() with status ok");
    if (s_m >= 0.0 && s_m <= length_m) return solver.Section(s_m);
    throw InputError(fmt::format("s_m: found {:g}, expected 0 to {:g}", s_m, length_m));
  }
};

void AddRodClass(py::module_& module) {
  using SharedRod = Shared<Rod>;
  py::class_<SharedRod>(
      module, "Rod",
      "The exact rod: inextensible, pinned at the wrist, sliding through the port. "
      "A solve starts from the last equilibrium.")
      .def(
          py::init(
              [](double length_m, double bending_stiffness_Nm2, const Eigen::Vector3d& q_weight) {
                return std::make_unique<SharedRod>(
                    Rod{Positive("length_m", length_m),
                        Positive("bending_stiffness_Nm2", bending_stiffness_Nm2), q_weight});
              }),
          py::arg("length_m"), py::arg("bending_stiffness_Nm2"),
          py::arg("q_weight") = Eigen::Vector3d::Zero().eval(),
          "length_m: from wrist to tip. bending_stiffness_Nm2: E I. q_weight: weight per length in "
          "R, (3,), N/m.")
      .def(
          "solve",
          [](SharedRod& rod, const Eigen::Vector3d& p_wrist, const Eigen::Vector3d& p_port,
             const Eigen::Vector3d& f_tip) {
            return rod.Use([&](Rod& r) { return r.Solve(p_wrist, p_port, f_tip); });
          },
          py::arg("p_wrist"), py::arg("p_port"), py::arg("f_tip") = Eigen::Vector3d::Zero().eval(),
          "Returns the equilibrium for wrist and port in R, (3,), m, under a force on the tip, "
          "(3,), "
          "N. That there is none is a status.")
      .def(
          "section",
          [](SharedRod& rod, double s_m) {
            return rod.Use([&](Rod& r) { return r.Section(s_m); });
          },
          py::arg("s_m"),
          "Returns the last solved rod at s_m from the wrist (m). Raises InputError where none was "
          "solved, and outside the rod.")
      .def(
          "reset",
          [](SharedRod& rod) {
            rod.Use([](Rod& r) {
              r.solver.Reset();
              r.solved = false;
            });
          },
          "Forgets the last equilibrium: the next solve starts from the straight shaft.");
}

/// A beam and the wrist it begins at.
struct Beam {
  BeamFit fit;
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();

  bool IsUsable() const {
    const bool fitted = fit.status == BeamStatus::kOk || fit.status == BeamStatus::kStraight;
    return fitted && fit.a > 0.0 && fit.a < fit.length_m;
  }
};

void AddBeam(py::module_& module) {
  const auto jacobian = [](const Beam& beam, const std::string& load_law) {
    const auto law = NamedOf<BeamLoadLaw>(
        "load_law",
        {{"tip_force", BeamLoadLaw::kTipForce}, {"port_force", BeamLoadLaw::kPortForce}}, load_law);
    return beam.IsUsable() ? std::optional<Eigen::Matrix3d>(BeamJacobian(beam.fit, law))
                           : std::nullopt;
  };
  py::class_<Beam>(module, "Beam",
                   "The thesis's beam: pinned at both ends, a point load at the port; in R. Where "
                   "there is none, all but the status is None.")
      .def_property_readonly(
          "status", [](const Beam& beam) { return Name(beam.fit.status); },
          "\"ok\", \"straight\" (no load across the shaft), or why there is no beam.")
      .def_property_readonly("F_p_over_EI",
                             IfUsable<Beam>([](const Beam& beam) { return beam.fit.F_p_over_EI; }),
                             "Force of the port over E I (1/m2).")
      .def_property_readonly("a_m", IfUsable<Beam>([](const Beam& beam) { return beam.fit.a; }),
                             "The port's place along the chord, from the wrist (m).")
      .def_property_readonly(
          "R_RM", IfUsable<Beam>([](const Beam& beam) { return beam.fit.R_RM; }),
          "Orientation of the beam's frame M: x from wrist to tip, bending in x-y, (3, 3).")
      .def_property_readonly("p_tip", IfUsable<Beam>([](const Beam& beam) {
                               return Eigen::Vector3d(BeamTip(beam.fit, beam.p_RW));
                             }),
                             "Tip, (3,), m.")
      .def("jacobian", jacobian, py::arg("load_law") = "tip_force",
           "Returns d tip / d wrist in R, (3, 3). load_law: the load that stays constant, "
           "\"tip_force\" or \"port_force\" (the thesis's). Raises InputError for another law.");
  module.def(
      "solve_beam",
      [](const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RP, const Eigen::Vector3d& f_tip,
         double bending_stiffness_Nm2, double length_m) {
        return Beam{SolveBeam(p_RW, p_RP, f_tip, bending_stiffness_Nm2, length_m), p_RW};
      },
      py::arg("p_RW"), py::arg("p_RP"), py::arg("f_tip"), py::arg("bending_stiffness_Nm2"),
      py::arg("length_m"),
      "Returns the thesis's beam through a wrist and a port (m) under a force on the tip (N), all "
      "in R, (3,).");
}

}  // namespace

void AddRod(py::module_& module) {
  AddShape(module);
  AddSection(module);
  AddRodState(module);
  AddRodClass(module);
  AddBeam(module);
}

}  // namespace flextip::python
