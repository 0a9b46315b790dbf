// The parts of the module _flextip, a subject a file. Each adds its types and functions to
// `module`.
#pragma once

#include <pybind11/pybind11.h>

namespace flextip::python {

namespace py = pybind11;

// In the order of module.cpp: a type is known before a signature names it.
void AddErrors(py::module_& module);
void AddInstrument(py::module_& module);
void AddCamera(py::module_& module);
void AddStreams(py::module_& module);
void AddSeenStreams(py::module_& module);
void AddRecording(py::module_& module);
void AddReadings(py::module_& module);
void AddRod(py::module_& module);
void AddDiagnosis(py::module_& module);
void AddEstimate(py::module_& module);
void AddTrack(py::module_& module);
void AddTracker(py::module_& module);
void AddController(py::module_& module);
void AddSimulation(py::module_& module);

}  // namespace flextip::python
