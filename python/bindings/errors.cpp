// Errors, warnings and judgements.
#include "python/bindings/errors.h"

#include <pybind11/stl.h>

#include "core/error.h"
#include "core/judgement.h"
#include "python/bindings/bindings.h"

namespace flextip::python {
namespace {

void NameAndExplain(const py::object& type, const char* doc) {
  type.attr("__module__") = "flextip";
  type.attr("__doc__") = doc;
}

void AddJudgement(py::module_& module) {
  py::class_<Judgement>(
      module, "Judgement",
      "How good a result is, and why, in a user's words: the head of the page that the "
      "program makes of it.")
      .def_property_readonly(
          "grade", [](const Judgement& j) { return Name(j.grade); },
          "\"good\", \"beware\" (use with care) or \"not found\" (no answer holds).")
      .def_readonly("says", &Judgement::says, "The answer in a sentence.")
      .def_readonly("reasons", &Judgement::reasons, "Reasons to be careful, and to know.")
      .def_readonly("next", &Judgement::next, "The next step.")
      .def_readonly("command", &Judgement::command, "The next step as a command; may be empty.")
      .def("__repr__", [](const Judgement& j) {
        return std::string("<Judgement ") + Name(j.grade) + ": " + j.says + ">";
      });
}

}  // namespace

void Warn(const std::vector<std::string>& texts) {
  const py::object category = py::module_::import("flextip._flextip").attr("RecordingWarning");
  for (const std::string& text : texts) {
    if (PyErr_WarnEx(category.ptr(), text.c_str(), 1) != 0) throw py::error_already_set();
  }
}

void AddErrors(py::module_& module) {
  NameAndExplain(py::register_exception<InputError>(module, "InputError", PyExc_ValueError),
                 "Input that cannot be used. One line: file and line where there are any, what was "
                 "found, what was expected.");
  NameAndExplain(py::register_exception<WorkError>(module, "WorkError", PyExc_RuntimeError),
                 "Work that was started on good input and failed, such as a full disk. One line.");
  const auto warning = py::reinterpret_steal<py::object>(
      PyErr_NewException("flextip.RecordingWarning", PyExc_UserWarning, nullptr));
  NameAndExplain(
      warning,
      "Data that a reader had to carry on without: a torn last line, a dropped frame, an "
      "unknown key.");
  module.attr("RecordingWarning") = warning;
  AddJudgement(module);
}

}  // namespace flextip::python
