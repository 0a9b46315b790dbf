#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/motion_error.h"
#include "reproduction/chapter3/noise.h"
#include "reproduction/chapter3/parts.h"

namespace flextip::reproduction {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const char* const kDepthLabel = "insertion depth r / L";

/// Noise as the captions give it: position over L, angle.
struct Scaling {
  double position = 0.002, angle_rad = 0.002;
};
constexpr Scaling kScalings[] = {
    {0.002, 0.002}, {0.001, 0.001}, {0.0005, 0.0005}, {0.00013 / 0.355, 0.00056}};
constexpr int kScalingCount = 4;

std::string Name(const Scaling& s) {
  return fmt::format("{:.3g} L, {:.3g} rad", s.position, s.angle_rad);
}

/// The worst errors over insertion depth.
struct Sweep {
  std::vector<double> depth;  ///< over L
  std::vector<WorstErrors> errors;
  std::vector<double> straight;  ///< the lever's metric there
};

Sweep SweepDepths(FlexionForm form, const BentShaft& shaft, const Scaling& noise, int points) {
  Sweep sweep;
  sweep.depth.resize(points);
  sweep.errors.resize(points);
  sweep.straight.resize(points);
  tbb::parallel_for(0, points, [&](int i) {
    const double x = 0.02 + 0.96 * i / (points - 1);
    const BeamState truth = BeamAtDepth(shaft, x * shaft.length_m);
    sweep.depth[i] = x;
    sweep.errors[i] =
        WorstOverNoise(form, truth, {noise.position * shaft.length_m, noise.angle_rad});
    sweep.straight[i] = FindStepError(FlexionJacobian(form, truth), LeverJacobian(truth)).norm;
  });
  return sweep;
}

constexpr double kHighest = 1e3;  // past it a curve says only that the estimate is worthless

report::FigureTrace Trace(const Sweep& sweep, double EstimateErrors::*which,
                          const std::string& name, double scale = 1.0) {
  report::FigureTrace trace{.name = name, .x = sweep.depth};
  for (const auto& errors : sweep.errors) {
    const double value = scale * errors.worst.*which;
    trace.y.push_back(value < kHighest ? value : kNaN);
  }
  return trace;
}

/// Where the metric is least, and the depths between which it stays below 1.
struct Converging {
  double best = kNaN, least = std::numeric_limits<double>::infinity();
  double from = kNaN, to = kNaN;
};
Converging ConvergingPart(const Sweep& sweep) {
  Converging part;
  for (std::size_t i = 0; i < sweep.depth.size(); ++i) {
    const double metric = sweep.errors[i].worst.metric;
    if (metric < part.least) {
      part.least = metric;
      part.best = sweep.depth[i];
    }
    if (!(metric < 1.0)) continue;
    if (std::isnan(part.from)) part.from = sweep.depth[i];
    part.to = sweep.depth[i];
  }
  return part;
}

report::Figure NewFigure(const std::string& name, const std::string& title,
                         const std::string& caption, const std::string& y_label) {
  return {.name = name,
          .title = title,
          .caption = caption,
          .x_label = kDepthLabel,
          .y_label = y_label,
          .log_y = true};
}

constexpr const char* kGap =
    " Lines end where the noise may put the port off the shaft: the worst is then without bound.";

std::vector<report::Figure> NoiseFigures() {
  const std::string at =
      " Worst over all errors within the bounds (of position over L, of angle). "
      "L = 0.355 m, F_t/EI = 3 1/m^2.";
  return {NewFigure("fig-3-6a", "Fig. 3.6: metric under noise, Jacobian as printed",
                    "Printed form against itself with noise; above 1 motions diverge." + at + kGap,
                    "metric ||G||"),
          NewFigure("fig-3-6b", "Fig. 3.6: metric under noise, corrected Jacobian, F_p held",
                    "The same with the corrected form. Noise decides, not the form." + at + kGap,
                    "metric ||G||"),
          NewFigure("fig-3-6c", "Fig. 3.6: metric under noise, corrected Jacobian, F_t held",
                    "The same with the tip's force held." + at + kGap, "metric ||G||"),
          NewFigure("fig-3-7", "Fig. 3.7: error of F_p/EI under noise",
                    "Relative error; it is the same for every Jacobian." + at + kGap,
                    "|error of F_p/EI| / (F_p/EI)"),
          NewFigure("fig-3-8", "Fig. 3.8: error of the port's position under noise",
                    "Distance of the estimated port from the true one, up to a metre." + at,
                    "port error (mm)")};
}

void AddNoiseRows(FlexionForm form, const Scaling& noise, const Sweep& sweep,
                  std::vector<TableRow>& rows) {
  const Converging part = ConvergingPart(sweep);
  const std::string what = fmt::format("{}, {}", Name(form), Name(noise));
  rows.push_back(
      {.quantity = "Fig. 3.6 r / L of the least metric, " + what,
       .thesis = 0.7,
       .flextip = part.best,
       .note = fmt::format("The least metric is {:.3f}; below 1 from {:.2f} L to {:.2f} L.",
                           part.least, part.from, part.to)});
}

/// Statements on the estimated force and port, at the captions' largest noise.
void AddEstimateRows(const Sweep& sweep, std::vector<TableRow>& rows) {
  const auto at = [&](double x) -> const WorstErrors& {
    const auto next = std::lower_bound(sweep.depth.begin(), sweep.depth.end(), x - 1e-9);
    return sweep.errors[std::size_t(next - sweep.depth.begin())];
  };
  double least = std::numeric_limits<double>::infinity(), best = kNaN, largest = 0.0;
  bool falls = true;
  for (std::size_t i = 0; i < sweep.depth.size(); ++i) {
    if (sweep.errors[i].worst.force < least) {
      least = sweep.errors[i].worst.force;
      best = sweep.depth[i];
    }
    largest = std::max(largest, sweep.errors[i].corners.force);
    if (i > 0 && sweep.errors[i].worst.port_m > sweep.errors[i - 1].worst.port_m) falls = false;
  }
  rows.push_back({.quantity = "Fig. 3.7 r / L of the least error of F_p/EI, 0.002 L, 0.002 rad",
                  .thesis = 0.5,
                  .flextip = best,
                  .note = fmt::format("The least error is {:.0f} %.", 100.0 * least)});
  rows.push_back(
      {.quantity = "Fig. 3.7 largest relative error of F_p/EI seen at a corner of the noise",
       .thesis = {},
       .flextip = largest,
       .note = "The text: wrong by orders of magnitude outside the convergent part. The "
               "supremum is infinite there: some noise puts the port at the shaft's end."});
  rows.push_back({.quantity = "Fig. 3.8 port error falls with every step of insertion (1: yes)",
                  .thesis = 1.0,
                  .flextip = falls ? 1.0 : 0.0});
  for (const double x : {0.3, 0.5, 0.7, 0.9}) {
    rows.push_back(
        {.quantity = fmt::format("Fig. 3.8 port error at r = {} L, 0.002 L, 0.002 rad", x),
         .thesis = {},
         .flextip = 1e3 * at(x).worst.port_m,
         .unit = "mm",
         .note = "Along the shaft nearly all of it: a is a ratio of small slopes."});
  }
}

/// Figs. 3.6 to 3.8.
void AddNoise(const ReproduceOptions& options, const ChapterProgress& progress,
              ChapterResult& result) {
  const BentShaft shaft;
  std::vector<report::Figure> figures = NoiseFigures();
  const int points = options.quick ? 25 : 193;
  for (int f = 0; f < 3; ++f) {
    const FlexionForm form = kFlexionForms[f];
    report::FigureTrace straight{.name = "straight shaft, no noise", .dashed = true};
    for (int n = 0; n < kScalingCount; ++n) {
      const Scaling& noise = kScalings[n];
      const Sweep sweep = SweepDepths(form, shaft, noise, points);
      figures[f].traces.push_back(Trace(sweep, &EstimateErrors::metric, Name(noise)));
      straight.x = sweep.depth;
      straight.y = sweep.straight;
      AddNoiseRows(form, noise, sweep, result.rows);
      progress((f * kScalingCount + n + 1) / 20.0);
      if (form != FlexionForm::kPortForce) continue;  // the estimates are those of every form
      figures[3].traces.push_back(Trace(sweep, &EstimateErrors::force, Name(noise)));
      figures[4].traces.push_back(Trace(sweep, &EstimateErrors::port_m, Name(noise), 1e3));
      if (n == 0) AddEstimateRows(sweep, result.rows);
    }
    figures[f].traces.push_back(straight);
  }
  std::move(figures.begin(), figures.end(), std::back_inserter(result.figures));
}

/// Fig. 3.9: one panel by length, one by force.
void AddLengthsAndForces(const ReproduceOptions& options, const ChapterProgress& progress,
                         ChapterResult& result) {
  const std::string caption =
      "Corrected Jacobian, F_p held; noise up to 0.002 L and 0.002 rad, worst over all of it; "
      "above 1 "
      "motions diverge.";
  report::Figure by_length = NewFigure("fig-3-9a", "Fig. 3.9: metric under noise by the length L",
                                       caption + " F_t/EI = 3 1/m^2." + kGap, "metric ||G||");
  report::Figure by_force = NewFigure("fig-3-9b", "Fig. 3.9: metric under noise by the tip's force",
                                      caption + " L = 0.355 m." + kGap, "metric ||G||");
  const int points = options.quick ? 25 : 193;
  const auto add = [&](const BentShaft& shaft, const std::string& name, report::Figure& figure) {
    const Sweep sweep = SweepDepths(FlexionForm::kPortForce, shaft, Scaling{}, points);
    figure.traces.push_back(Trace(sweep, &EstimateErrors::metric, name));
    const Converging part = ConvergingPart(sweep);
    result.rows.push_back(
        {.quantity = fmt::format("Fig. 3.9 least metric, L = {} m, F_t/EI = {} 1/m^2",
                                 shaft.length_m, shaft.F_t_over_EI),
         .thesis = {},
         .flextip = std::isfinite(part.least) ? std::optional(part.least) : std::nullopt,
         .note =
             std::isnan(part.from)
                 ? "Below 1 nowhere; empty: some noise puts the port off the shaft at every depth."
                 : fmt::format("Below 1 from {:.2f} L to {:.2f} L. The bending goes as "
                               "F_t L^2/EI: a longer shaft is a larger force.",
                               part.from, part.to)});
  };
  for (const double L : {0.25, 0.355, 0.5, 0.7})
    add({L, 3.0}, fmt::format("L = {} m", L), by_length);
  progress(0.8);
  for (const double F : {2.0, 3.0, 6.0, 12.0})
    add({0.355, F}, fmt::format("F_t/EI = {} 1/m²", F), by_force);
  result.figures.push_back(by_length);
  result.figures.push_back(by_force);
}

}  // namespace

ChapterResult Ch3Sensitivity(const ReproduceOptions& options, const ChapterProgress& progress) {
  ChapterResult result;
  AddNoise(options, progress, result);
  AddLengthsAndForces(options, progress, result);
  progress(1.0);
  return result;
}

}  // namespace flextip::reproduction
