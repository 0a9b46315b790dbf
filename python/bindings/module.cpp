// The module _flextip: the libraries on numpy. A binding converts its arguments, makes the call
// that the program's command makes, and converts the result (docs/architecture.md has the calls).
#include "core/version.h"
#include "python/bindings/bindings.h"

PYBIND11_MODULE(_flextip, module) {
  using namespace flextip::python;
  module.doc() = "Compiled part of flextip; import flextip instead.";
  module.attr("__version__") = flextip::kVersion;
  AddErrors(module);
  AddInstrument(module);
  AddCamera(module);
  AddStreams(module);
  AddSeenStreams(module);
  AddRecording(module);
  AddReadings(module);
  AddRod(module);
  AddDiagnosis(module);
  AddEstimate(module);
  AddTrack(module);
  AddTracker(module);
  AddController(module);
  AddSimulation(module);
}
