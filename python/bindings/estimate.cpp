// Load, port and shape at every sample of a recording.
#include <fmt/format.h>

#include "core/error.h"
#include "diagnosis/model/extended_instrument.h"
#include "diagnosis/model/latency.h"
#include "pipeline/estimate_recording.h"
#include "pipeline/judge_estimates.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"

namespace flextip::python {
namespace {

using diagnosis::ExtendedModel;

/// What flextip estimate writes, as an object.
struct Estimates {
  Series<ShaftEstimate> samples;
  EstimateTotals totals;
  Judgement judgement;
  std::optional<WindowEstimate> window;
};

bool IsThere(const ShaftEstimate& e) {
  return e.status == EstimateStatus::kOk || e.status == EstimateStatus::kUnobservable;
}

/// The stages of the command estimate, in its order.
Estimates EstimateWhole(const Recording& recording, const std::optional<ExtendedModel>& found,
                        double port_prior_m, int window_samples, bool use_positions) {
  if (!recording.wrist0) throw InputError("no wrist0, without which nothing can be estimated");
  if (window_samples != 0 && (window_samples < 2 || window_samples > 1000)) {
    throw InputError(
        fmt::format("window_samples: found {}, expected 0 or 2 to 1000", window_samples));
  }
  EstimatorOptions options =
      EstimatorOptionsFor(recording.instrument, recording.p_RP, recording.gravity_m_s2,
                          Positive("port_prior_m", port_prior_m));
  options.use_positions = use_positions;
  options.estimate_tissue = false;  // for the controllers only
  InstrumentEstimator estimator(options, window_samples);
  Interruption interruption;
  const auto progress = [&](std::size_t, std::size_t) { interruption.Check(); };
  Estimates estimates;
  if (found) {
    diagnosis::ExtendedInstrument model(*found, recording);
    estimates.samples = EstimateRecording(diagnosis::WithoutLatency(recording, *found), estimator,
                                          &model, progress);
  } else {
    estimates.samples = EstimateRecording(recording, estimator, nullptr, progress);
  }
  if (estimates.samples.empty()) throw WorkError("no sample could be estimated");
  estimates.totals = TotalsOf(estimates.samples);
  estimates.judgement = JudgeEstimates(estimates.totals);
  if (estimator.Window() != nullptr) estimates.window = *estimator.Window();
  return estimates;
}

/// Gives the array (N, shape...) whose rows `put` fills where there is an estimate.
template <class Write>
auto EstimateRows(std::vector<py::ssize_t> shape, Write write) {
  return [shape, write](const Estimates& e) {
    return Table(e.samples, shape, [&](const Sample<ShaftEstimate>& sample, double* row) {
      if (IsThere(sample.value)) write(sample.value, row);
    });
  };
}

template <class Part>
auto IfEstimated(Part part) {
  return [part](const ShaftEstimate& e) {
    using Value = std::decay_t<decltype(part(e))>;
    return IsThere(e) ? std::optional<Value>(part(e)) : std::nullopt;
  };
}

void AddShaftEstimate(py::module_& module) {
  py::class_<ShaftEstimate>(module, "ShaftEstimate",
                            "Load, port and shape of an instant, in R. Where the status is neither "
                            "\"ok\" nor \"unobservable\" all else is None.")
      .def_property_readonly(
          "status", [](const ShaftEstimate& e) { return Name(e.status); },
          "\"ok\", \"unobservable\" (taken as unloaded), \"not_converged\" or \"bad_input\".")
      .def_property_readonly("p_RE", IfEstimated([](const ShaftEstimate& e) { return e.p_RE; }),
                             "Tip, (3,), m.")
      .def_property_readonly("p_RE_covariance_m2", IfEstimated([](const ShaftEstimate& e) {
                               return e.p_RE_covariance_m2;
                             }),
                             "Its covariance, (3, 3), m2.")
      .def_property_readonly("d_RE", IfEstimated([](const ShaftEstimate& e) { return e.d_RE; }),
                             "The tip's direction, unit, (3,).")
      .def_property_readonly("f_tip_N",
                             IfEstimated([](const ShaftEstimate& e) { return e.model.f_tip_N; }),
                             "Force on the tip, (3,), N.")
      .def_property_readonly("p_RP",
                             IfEstimated([](const ShaftEstimate& e) { return e.model.p_RP; }),
                             "Port, (3,), m.")
      .def_property_readonly("covariance",
                             IfEstimated([](const ShaftEstimate& e) { return e.covariance; }),
                             "Covariance of wrist (m), port (m) and tip force (N), (9, 9).")
      .def_property_readonly("s_port_m",
                             IfEstimated([](const ShaftEstimate& e) { return e.s_port_m; }),
                             "The port, from the wrist along the shaft (m).")
      .def_property_readonly("chi2", IfEstimated([](const ShaftEstimate& e) { return e.chi2; }),
                             "Of the measurements and priors.")
      .def_readonly("measurements", &ShaftEstimate::measurements, "Scalar measurements used.");
}

void AddTotals(py::module_& module) {
  py::class_<EstimateTotals>(module, "EstimateTotals", "What the estimates say together.")
      .def_readonly("samples", &EstimateTotals::samples, "Samples.")
      .def_readonly("ok", &EstimateTotals::ok, "Of those, estimated.")
      .def_readonly("unobservable", &EstimateTotals::unobservable, "Taken as unloaded.")
      .def_readonly("not_converged", &EstimateTotals::not_converged, "No rod fits.")
      .def_readonly("bad_input", &EstimateTotals::bad_input, "A measurement was not finite.")
      .def_readonly("chi2_per_measurement", &EstimateTotals::chi2_per_measurement,
                    "Of all samples together; 0 where nothing was measured.")
      .def_readonly("tip_sd_m", &EstimateTotals::tip_sd_m,
                    "Median standard deviation per axis of the tip (m).")
      .def_readonly("force_across_sd_N", &EstimateTotals::force_across_sd_N,
                    "Median standard deviation of the force across the shaft (N).")
      .def_readonly("force_along_sd_N", &EstimateTotals::force_along_sd_N,
                    "Median standard deviation of the force along the shaft (N).");
  py::class_<WindowEstimate>(module, "WindowEstimate", "The port by many samples together.")
      .def_property_readonly(
          "status", [](const WindowEstimate& w) { return Name(w.status); },
          "\"ok\", \"unobservable\" or \"not_converged\": then the registration stands.")
      .def_readonly("samples", &WindowEstimate::samples, "Samples in the window.")
      .def_property_readonly(
          "port_shift_m", [](const WindowEstimate& w) { return Eigen::Vector3d(w.port_shift_m); },
          "From where the port is registered, in R, (3,), m.")
      .def_property_readonly(
          "port_covariance_m2",
          [](const WindowEstimate& w) { return Eigen::Matrix3d(w.port_covariance_m2); },
          "Its covariance, (3, 3), m2.")
      .def_readonly("least_known_sd_m", &WindowEstimate::least_known_sd_m,
                    "Standard deviation across the shaft where it is known least (m).");
}

void AddEstimates(py::module_& module) {
  py::class_<Estimates>(module, "Estimates",
                        "Load, port and shape at every sample, in R. Rows whose status is neither "
                        "\"ok\" nor \"unobservable\" are zeros.")
      .def("__len__", [](const Estimates& e) { return e.samples.size(); })
      .def("__repr__",
           [](const Estimates& e) {
             return fmt::format("<Estimates of {} samples, {}: {}>", e.samples.size(),
                                Name(e.judgement.grade), e.judgement.says);
           })
      .def_property_readonly(
          "t_ns", [](const Estimates& e) { return Times(e.samples); }, "Times, (N,) int64, ns.")
      .def_property_readonly(
          "status",
          [](const Estimates& e) {
            return TextColumn(e.samples, [](const auto& s) { return Name(s.value.status); });
          },
          "\"ok\", \"unobservable\" (taken as unloaded), \"not_converged\" or \"bad_input\", (N,).")
      .def_property_readonly(
          "p_RE", EstimateRows({3}, [](const ShaftEstimate& e, double* row) { Put(e.p_RE, row); }),
          "Tip, (N, 3), m.")
      .def_property_readonly(
          "p_RE_covariance_m2",
          EstimateRows({3, 3},
                       [](const ShaftEstimate& e, double* row) { Put(e.p_RE_covariance_m2, row); }),
          "Its covariance, (N, 3, 3), m2.")
      .def_property_readonly(
          "d_RE", EstimateRows({3}, [](const ShaftEstimate& e, double* row) { Put(e.d_RE, row); }),
          "The tip's direction, unit, (N, 3).")
      .def_property_readonly(
          "f_tip_N",
          EstimateRows({3}, [](const ShaftEstimate& e, double* row) { Put(e.model.f_tip_N, row); }),
          "Force on the tip, (N, 3), N.")
      .def_property_readonly(
          "p_RP",
          EstimateRows({3}, [](const ShaftEstimate& e, double* row) { Put(e.model.p_RP, row); }),
          "Port, (N, 3), m.")
      .def_property_readonly(
          "covariance",
          EstimateRows({9, 9}, [](const ShaftEstimate& e, double* row) { Put(e.covariance, row); }),
          "Covariance of wrist (m), port (m) and tip force (N), (N, 9, 9).")
      .def_property_readonly(
          "s_port_m",
          EstimateRows({}, [](const ShaftEstimate& e, double* row) { *row = e.s_port_m; }),
          "The port, from the wrist along the shaft, (N,), m.")
      .def_property_readonly(
          "chi2", EstimateRows({}, [](const ShaftEstimate& e, double* row) { *row = e.chi2; }),
          "Of the measurements and priors, (N,).")
      .def_property_readonly(
          "measurements",
          [](const Estimates& e) {
            return Column<TimeNs>(e.samples,
                                  [](const auto& s) { return TimeNs(s.value.measurements); });
          },
          "Scalar measurements used, (N,) int64.")
      .def_readonly("totals", &Estimates::totals, "What they say together.")
      .def_readonly("judgement", &Estimates::judgement, "Whether they hold.")
      .def_readonly("window", &Estimates::window,
                    "The port by the window's last estimate; None without a window.");
}

}  // namespace

void AddEstimate(py::module_& module) {
  AddShaftEstimate(module);
  AddTotals(module);
  AddEstimates(module);
  module.def(
      "estimate",
      [](Recording recording, std::optional<ExtendedModel> model, double port_prior_m,
         int window_samples, bool use_positions) {
        return WithoutGil([&] {
          return EstimateWhole(recording, model, port_prior_m, window_samples, use_positions);
        });
      },
      py::arg("recording"), py::kw_only(), py::arg("model") = std::nullopt,
      py::arg("port_prior_m") = kPortRegistration_m, py::arg("window_samples") = 0,
      py::arg("use_positions") = true,
      R"doc(Estimates load, port and shape at every sample of a recording.

model: what a diagnosis found. port_prior_m: how well the port is registered, standard deviation per
axis. window_samples: find the port from so many samples together, 2 to 1000; 0: none.
use_positions: False leaves out the places of tip and EM sensor.

Samples that cannot be estimated are a status. Raises InputError without wrist0, WorkError where no
sample could be estimated.)doc");
}

}  // namespace flextip::python
