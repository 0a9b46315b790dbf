// What a recording holds that the base simulation does not: diagnose() and found models.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "core/error.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/judge_diagnosis.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/model/extended_model.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"
#include "simulation/closed_loop/gain.h"

namespace flextip::python {
namespace {

using diagnosis::DiagnosisResult;
using diagnosis::EffectFit;
using diagnosis::ExtendedModel;
using diagnosis::ModelScore;
using simulation::ClosedLoopGain;
using simulation::ControllerGain;

/// What flextip diagnose writes, as an object.
struct Diagnosis {
  DiagnosisResult result;
  ExtendedModel model;
  std::optional<ClosedLoopGain> closed_loop;
  Judgement judgement;
};

struct Parameter {
  std::vector<double> value, sd;
};
using ParametersByEffect = std::map<std::string, std::map<std::string, Parameter>>;

ParametersByEffect ByEffect(const std::vector<EffectFit>& fits) {
  ParametersByEffect effects;
  for (const EffectFit& fit : fits) {
    for (const auto& p : fit.parameters) effects[fit.effect][p.name] = {p.value, p.sd};
  }
  return effects;
}

/// The stages of the command diagnose, in its order.
Diagnosis DiagnoseWhole(const Recording& recording, const std::string& name,
                        const std::vector<std::string>& without, bool closed_loop) {
  Diagnosis d;
  d.result = diagnosis::Diagnose(recording, name, {.without = without});
  d.model = diagnosis::FromResult(d.result);
  if (closed_loop && diagnosis::NamesEffects(d.result.verdict)) {
    d.closed_loop = simulation::MeasureClosedLoopGain(recording, d.model);
  }
  d.judgement = diagnosis::JudgeDiagnosis(d.result);
  return d;
}

/// Gives a member of the result, as a copy.
template <class T>
auto OfResult(T DiagnosisResult::*member) {
  return [member](const Diagnosis& d) { return T(d.result.*member); };
}

void AddModel(py::module_& module) {
  py::class_<Parameter>(module, "Parameter", "A parameter of an effect (docs/effects.md), SI.")
      .def_property_readonly(
          "value", [](const Parameter& p) { return py::array_t<double>(py::cast(p.value)); },
          "Value, (N,).")
      .def_property_readonly(
          "sd", [](const Parameter& p) { return py::array_t<double>(py::cast(p.sd)); },
          "Standard deviation, (N,).");
  py::class_<ExtendedModel>(module, "Model",
                            "The base simulation with the effects that a diagnosis found.")
      .def_property_readonly(
          "effects", [](const ExtendedModel& m) { return ByEffect(m.effects); },
          "Effects beyond tolerance: {effect: {parameter: Parameter}}.")
      .def_property_readonly(
          "within_tolerance", [](const ExtendedModel& m) { return ByEffect(m.within_tolerance); },
          "All others, as far as the data moved them.")
      .def_property_readonly(
          "covariance", [](const ExtendedModel& m) { return m.covariance; },
          "Covariance of the numbers under effects, (M, M).")
      .def_property_readonly(
          "covariance_names", [](const ExtendedModel& m) { return NumberNames(m.effects); },
          "Names of its rows, \"effect.parameter[0]\".");
  module.def(
      "read_model", [](const std::filesystem::path& file) { return diagnosis::ReadModel(file); },
      py::arg("file"), "Reads model.yaml. Raises InputError with file and line.");
  module.def("write_model", &diagnosis::WriteModel, py::arg("file"), py::arg("model"),
             "Writes model.yaml. Raises WorkError where the file cannot be written.");
}

void AddScores(py::module_& module) {
  py::class_<ModelScore>(module, "ModelScore",
                         "Errors of a model on parts of the recording that were not fitted.")
      .def_readonly("heldout_rms", &ModelScore::heldout_rms,
                    "RMS by channel, in the channel's unit.")
      .def_readonly("tip_prediction_rms_m", &ModelScore::tip_prediction_rms_m,
                    "RMS of the tip (or EM sensor) from all other sensors (m).")
      .def_readonly("weighted_rms", &ModelScore::weighted_rms,
                    "RMS of all channels, in standard deviations.")
      .def_readonly("chi2_per_dof", &ModelScore::chi2_per_dof, "Of the whole recording.");
  py::class_<diagnosis::Gain>(module, "Gain", "Errors of the extended over the base model.")
      .def_readonly("heldout_error_ratio", &diagnosis::Gain::heldout_error_ratio,
                    "Ratio of the weighted RMS on held-out parts.")
      .def_property_readonly(
          "heldout_error_ratio_interval",
          [](const diagnosis::Gain& g) {
            return std::make_pair(g.heldout_error_ratio_low, g.heldout_error_ratio_high);
          },
          "90 % interval of that ratio.")
      .def_readonly("tip_error_ratio", &diagnosis::Gain::tip_error_ratio,
                    "Ratio of tip_prediction_rms_m.");
  py::class_<diagnosis::Signature>(module, "Signature",
                                   "A channel's base residual depends on a quantity.")
      .def_readonly("channel", &diagnosis::Signature::channel, "The channel.")
      .def_readonly("against", &diagnosis::Signature::against, "The quantity.")
      .def_readonly("score", &diagnosis::Signature::score, "In standard deviations of chance.");
  py::class_<diagnosis::ResidualMemory>(module, "ResidualMemory",
                                        "How long what the answer leaves stays the same.")
      .def_readonly("channel", &diagnosis::ResidualMemory::channel,
                    "The channel with the largest slow part; empty: none.")
      .def_readonly("correlation", &diagnosis::ResidualMemory::correlation,
                    "Of its residuals, from sample to sample.")
      .def_property_readonly("samples_as_one", &diagnosis::ResidualMemory::SamplesAsOne,
                             "Samples that tell as much as one that is independent.");
  py::class_<ControllerGain>(module, "ControllerGain",
                             "A controller in closed loop without and with the found model.")
      .def_property_readonly(
          "controller", [](const ControllerGain& g) { return Name(g.kind); }, "Its name.")
      .def_readonly("ran", &ControllerGain::ran,
                    "False: the simulated instrument lost its equilibrium; the rest is 0.")
      .def_property_readonly(
          "base_max_m", [](const ControllerGain& g) { return g.base.max_m; },
          "Largest deviation without the model (m).")
      .def_property_readonly(
          "base_rms_m", [](const ControllerGain& g) { return g.base.rms_m; },
          "RMS deviation without the model (m).")
      .def_property_readonly(
          "extended_max_m", [](const ControllerGain& g) { return g.extended.max_m; },
          "Largest deviation with the model (m).")
      .def_property_readonly(
          "extended_rms_m", [](const ControllerGain& g) { return g.extended.rms_m; },
          "RMS deviation with the model (m).");
}

void AddResiduals(py::class_<Diagnosis>& answer) {
  answer
      .def_property_readonly(
          "residual_columns", [](const Diagnosis& d) { return d.result.residuals.columns; },
          "Names: t_s, regressors, base.CHANNEL.i, extended.CHANNEL.i (in standard deviations).")
      .def_property_readonly(
          "residuals",
          [](const Diagnosis& d) {
            const auto& table = d.result.residuals;
            return Table(table.rows, {static_cast<py::ssize_t>(table.columns.size())},
                         [](const auto& values, double* row) {
                           std::copy(values.begin(), values.end(), row);
                         });
          },
          "Residuals of every sample, (N, columns); 0 where residuals_present is False.")
      .def_property_readonly(
          "residuals_present",
          [](const Diagnosis& d) {
            const auto& table = d.result.residuals;
            return Table<bool>(table.present, {static_cast<py::ssize_t>(table.columns.size())},
                               [](const auto& values, bool* row) {
                                 std::copy(values.begin(), values.end(), row);
                               });
          },
          "Whether it was measured, (N, columns).");
}

void AddAnswer(py::class_<Diagnosis>& answer) {
  answer.def_readonly("judgement", &Diagnosis::judgement, "Whether the answer holds.")
      .def("__repr__",
           [](const Diagnosis& d) {
             return fmt::format("<Diagnosis, {}: {}>", Name(d.judgement.grade), d.judgement.says);
           })
      .def_property_readonly("verdicts", OfResult(&DiagnosisResult::verdict),
                             "Effects judged present; [\"none\"] and [\"unknown\"] are answers.")
      .def_property_readonly(
          "probabilities",
          [](const Diagnosis& d) {
            py::dict by_name;  // the most likely first
            for (const auto& h : d.result.probabilities) {
              by_name[py::str(diagnosis::Joined(h.verdict))] = h.probability;
            }
            return by_name;
          },
          "Probability of each hypothesis, \"a\" or \"a+b\", the most likely first; sum one.")
      .def_property_readonly("presence", OfResult(&DiagnosisResult::presence),
                             "Probability of each effect, alone or with others.")
      .def_property_readonly("credible_set", OfResult(&DiagnosisResult::credible_set),
                             "Hypotheses that together hold 90 %.")
      .def_property_readonly("indistinguishable", OfResult(&DiagnosisResult::indistinguishable),
                             "One group of effects for each verdict.")
      .def_property_readonly("separating_motion", OfResult(&DiagnosisResult::separating_motion),
                             "The motion that would tell a group apart; empty: none needed.")
      .def_property_readonly(
          "parameters", [](const Diagnosis& d) { return ByEffect(d.result.parameters); },
          "Of the verdict's effects: {effect: {parameter: Parameter}}.")
      .def_property_readonly(
          "within_tolerance",
          [](const Diagnosis& d) { return ByEffect(d.result.within_tolerance); },
          "Of all others, as far as the data moved them.")
      .def_readonly("model", &Diagnosis::model, "What was found, as a model.");
}

}  // namespace

void AddDiagnosis(py::module_& module) {
  AddModel(module);
  AddScores(module);
  py::class_<Diagnosis> answer(module, "Diagnosis", "The answer of diagnose().");
  AddAnswer(answer);
  answer
      .def_property_readonly("base", OfResult(&DiagnosisResult::base),
                             "Errors of the base simulation.")
      .def_property_readonly("extended", OfResult(&DiagnosisResult::extended),
                             "Errors of the extended model.")
      .def_property_readonly(
          "gain",
          [](const Diagnosis& d) {
            return d.result.gain.measured ? std::optional(d.result.gain) : std::nullopt;
          },
          "Errors of the extended over the base model; None where they were not measured.")
      .def_property_readonly(
          "closed_loop",
          [](const Diagnosis& d) {
            return d.closed_loop ? d.closed_loop->controllers : std::vector<ControllerGain>();
          },
          "Controllers with and without the model on a simulated instrument that has what was "
          "found; empty where nothing was.")
      .def_property_readonly("signatures", OfResult(&DiagnosisResult::signatures),
                             "What the base residual depends on, the strongest first.")
      .def_property_readonly("memory", OfResult(&DiagnosisResult::memory),
                             "How long what the answer leaves stays the same.")
      .def_property_readonly("catalogue", OfResult(&DiagnosisResult::catalogue),
                             "Effects that this recording could show.")
      .def_property_readonly("summaries", OfResult(&DiagnosisResult::summaries),
                             "A line on each of them.")
      .def_property_readonly("samples", OfResult(&DiagnosisResult::samples), "Samples used.")
      .def_property_readonly("converged", OfResult(&DiagnosisResult::converged),
                             "Whether the search came to rest.")
      .def_property_readonly(
          "warnings",
          [](const Diagnosis& d) {
            std::vector<std::string> warnings = d.result.warnings;
            if (d.closed_loop && !d.closed_loop->warning.empty()) {
              warnings.push_back(d.closed_loop->warning);
            }
            return warnings;
          },
          "What to be careful about, one line each.");
  AddResiduals(answer);
  module.def(
      "diagnose",
      [](Recording recording, const std::string& name, const std::vector<std::string>& without,
         bool closed_loop) {
        return WithoutGil([&] { return DiagnoseWhole(recording, name, without, closed_loop); });
      },
      py::arg("recording"), py::kw_only(), py::arg("name") = "recording",
      py::arg("without") = std::vector<std::string>(), py::arg("closed_loop") = true,
      R"doc(Finds what the base simulation gets wrong, why, and what an extended model gains.

name: of the recording in messages. without: effects left out of the catalogue. closed_loop: also
run the controllers with and without what was found. Takes seconds to minutes, on all cores; Ctrl-C
is heard at its end. Raises InputError where nothing can be judged.)doc");
}

}  // namespace flextip::python
