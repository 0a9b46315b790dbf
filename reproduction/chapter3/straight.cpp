#include <fmt/format.h>

#include <cmath>

#include "control/motion_error.h"
#include "reproduction/chapter3/beam.h"
#include "reproduction/chapter3/parts.h"
#include "reproduction/chapter3/rod.h"

namespace flextip::reproduction {
namespace {

constexpr double kFirst = 0.02, kLast = 0.98;  // insertion depths over the length
const char* const kDepthLabel = "insertion depth r / L";

double LeverMetric(FlexionForm form, const BeamState& state) {
  return FindStepError(FlexionJacobian(form, state), LeverJacobian(state)).norm;
}

/// How far the values are from the straight line through zero that fits them best, rms over the
/// largest value.
double OffProportional(const report::FigureTrace& trace) {
  double xx = 0.0, xy = 0.0, squares = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < trace.x.size(); ++i) {
    xx += trace.x[i] * trace.x[i];
    xy += trace.x[i] * trace.y[i];
    largest = std::max(largest, trace.y[i]);
  }
  for (std::size_t i = 0; i < trace.x.size(); ++i)
    squares += std::pow(trace.y[i] - xy / xx * trace.x[i], 2);
  return std::sqrt(squares / static_cast<double>(trace.x.size())) / largest;
}

struct Curves {
  report::FigureTrace tip_beam{.name = "beam"}, tip_rod{.name = "exact rod", .dashed = true};
  report::FigureTrace lever[3];  // of each form as the truth
  report::FigureTrace lever_rod{.name = "truth: exact rod", .dashed = true};
  report::FigureTrace beam_on_rod[3], lever_on_rod{.name = "straight"};
};

Curves MakeCurves(const BentShaft& shaft, int points) {
  Curves curves;
  for (int f = 0; f < 3; ++f) {
    curves.lever[f].name = fmt::format("truth: beam {}", Name(kFlexionForms[f]));
    curves.beam_on_rod[f].name = fmt::format("beam {}", Name(kFlexionForms[f]));
  }
  const auto add = [](report::FigureTrace& trace, double x, double y) {
    trace.x.push_back(x);
    trace.y.push_back(y);
  };
  for (int i = 0; i < points; ++i) {
    const double x = kFirst + (kLast - kFirst) * i / (points - 1);
    const double L = shaft.length_m;
    const BeamState beam = BeamAtDepth(shaft, x * L);
    add(curves.tip_beam, x, 1e3 * (LeverTip(beam) - beam.Tip()).norm());
    for (int f = 0; f < 3; ++f) add(curves.lever[f], x, LeverMetric(kFlexionForms[f], beam));

    const PlaneRodState rod = PlaneRodAt(shaft, (1.0 - x) * L);
    const BeamState fit = EstimateBeam(rod.readings, L);
    const double r = rod.depth_m / L;
    const double on_rod = FindStepError(rod.J_tip_wrist, LeverJacobian(rod.lever)).norm;
    add(curves.tip_rod, r, 1e3 * (LeverTip(rod.lever) - rod.readings.segment<2>(2)).norm());
    add(curves.lever_rod, r, on_rod);
    add(curves.lever_on_rod, r, on_rod);
    for (int f = 0; f < 3; ++f) {
      const Eigen::Matrix2d J = FlexionJacobian(kFlexionForms[f], fit);
      add(curves.beam_on_rod[f], r, FindStepError(rod.J_tip_wrist, J).norm);
    }
  }
  return curves;
}

std::vector<report::Figure> Figures(const Curves& curves) {
  std::vector<report::Figure> figures(3);
  figures[0] = {.name = "fig-3-5a",
                .title = "Fig. 3.5: tip error of a straight shaft",
                .caption =
                    "How far the tip of the lever equation (3.27) is from the tip of the bent "
                    "shaft. L = 0.355 m, F_t/EI = 3 1/m^2.",
                .x_label = kDepthLabel,
                .y_label = "tip error (mm)",
                .traces = {curves.tip_beam, curves.tip_rod}};
  figures[1] = {.name = "fig-3-5b",
                .title = "Fig. 3.5: motion error of a straight shaft's Jacobian",
                .caption =
                    "The metric (2.6) of the lever's Jacobian, for four truths. Above 1 the "
                    "motions diverge. Held F_t and the exact rod are one line.",
                .x_label = kDepthLabel,
                .y_label = "metric ||G||",
                .log_y = true,
                .traces = {curves.lever[0], curves.lever[1], curves.lever[2], curves.lever_rod}};
  figures[2] = {.name = "fig-3-10",
                .title = "Beyond the thesis: the beam's Jacobian on the exact rod, without noise",
                .caption =
                    "The truth is the exact rod with its tip force held; the beam is fitted to "
                    "the rod's own positions and angles by (3.11), (3.12). What is left is "
                    "the model's error.",
                .x_label = kDepthLabel,
                .y_label = "metric ||G||",
                .log_y = true,
                .traces = {curves.beam_on_rod[0], curves.beam_on_rod[1], curves.beam_on_rod[2],
                           curves.lever_on_rod}};
  return figures;
}

void AddRows(const BentShaft& shaft, const Curves& curves, std::vector<TableRow>& rows) {
  const double L = shaft.length_m;
  for (const double x : {0.5, 0.9}) {
    rows.push_back(
        {.quantity = fmt::format("Fig. 3.5 tip error of the straight shaft, r = {} L", x),
         .thesis = x == 0.9 ? std::optional(10.0) : std::nullopt,
         .flextip =
             1e3 * (LeverTip(BeamAtDepth(shaft, x * L)) - BeamAtDepth(shaft, x * L).Tip()).norm(),
         .unit = "mm",
         .note = "The text has it on the order of centimetres (3.5)."});
  }
  for (int f = 0; f < 3; ++f) {
    rows.push_back(
        {.quantity =
             fmt::format("3.4.1 straight Jacobian's metric, off proportional to r, truth {}",
                         Name(kFlexionForms[f])),
         .thesis = 0.0,
         .flextip = OffProportional(curves.lever[f]),
         .note = "Rms from the line through zero, over the largest value, r from 0.02 L to 0.98 L. "
                 "Proportional, as the text says, only with F_t held; as printed up to half the "
                 "length."});
  }
  rows.push_back({.quantity = "3.4.1 the same, truth the exact rod",
                  .thesis = 0.0,
                  .flextip = OffProportional(curves.lever_rod)});
  for (int f = 0; f < 3; ++f) {
    const PlaneRodState rod = PlaneRodAt(shaft, 0.3 * L);
    const BeamState fit = EstimateBeam(rod.readings, L);
    rows.push_back(
        {.quantity = fmt::format("3.5 metric without noise on the exact rod, r = 0.7 L, beam {}",
                                 Name(kFlexionForms[f])),
         .thesis = 0.0,
         .flextip = FindStepError(rod.J_tip_wrist, FlexionJacobian(kFlexionForms[f], fit)).norm,
         .note = fmt::format("Barring noise the flexion model is said to command accurate motions. "
                             "The straight Jacobian's: {:.3f}.",
                             FindStepError(rod.J_tip_wrist, LeverJacobian(rod.lever)).norm)});
  }
}

}  // namespace

ChapterResult Ch3Straight(const ReproduceOptions& options, const ChapterProgress& progress) {
  const BentShaft shaft;
  const Curves curves = MakeCurves(shaft, options.quick ? 25 : 97);
  ChapterResult result;
  result.figures = Figures(curves);
  AddRows(shaft, curves, result.rows);
  progress(1.0);
  return result;
}

}  // namespace flextip::reproduction
