// The instrument's shaft as data.
#include "core/instrument.h"

#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"

namespace flextip::python {
namespace {

Instrument MakeInstrument(double length_m, double bending_stiffness_Nm2, double outer_diameter_m,
                          double mass_per_length_kg_m, double stiffness_taper) {
  return {Positive("length_m", length_m), NotNegative("outer_diameter_m", outer_diameter_m),
          Positive("bending_stiffness_Nm2", bending_stiffness_Nm2),
          NotNegative("mass_per_length_kg_m", mass_per_length_kg_m), stiffness_taper};
}

}  // namespace

void AddInstrument(py::module_& module) {
  py::class_<Instrument>(module, "Instrument", "Nominal data of a shaft with a circular section.")
      .def(py::init(&MakeInstrument), py::arg("length_m"), py::arg("bending_stiffness_Nm2"),
           py::kw_only(), py::arg("outer_diameter_m") = 0.0, py::arg("mass_per_length_kg_m") = 0.0,
           py::arg("stiffness_taper") = 0.0,
           "Raises InputError for a length or stiffness not above zero.")
      .def_readonly("length_m", &Instrument::length_m,
                    "From the wrist's pivot to the tip, along the shaft (m).")
      .def_readonly("outer_diameter_m", &Instrument::outer_diameter_m, "Outer diameter (m).")
      .def_readonly("bending_stiffness_Nm2", &Instrument::bending_stiffness_Nm2,
                    "E I (N m2), in the middle where it tapers.")
      .def_readonly("mass_per_length_kg_m", &Instrument::mass_per_length_kg_m,
                    "Mass per length (kg/m); 0: weight is not modelled.")
      .def_readonly("stiffness_taper", &Instrument::stiffness_taper,
                    "E I (1 + taper (s / L - 1/2)), s from the wrist.");
}

}  // namespace flextip::python
