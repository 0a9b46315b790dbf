#include "bench/fault_campaign/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/fault_campaign/healthy.h"
#include "simulation/sensors/sensors.h"

namespace flextip::bench {
namespace {

using simulation::LoopUpdate;

constexpr int kColumns = 3, kWidth = 360, kHeight = 170, kLeft = 44, kTop = 44, kStrip = 10;
constexpr double kPlotWidth = kWidth - kLeft - 12, kPlotHeight = kHeight - kTop - 36;

double TimeOf(const LoopUpdate& update) {
  return 1e-9 * static_cast<double>(update.t_ns - simulation::kSimulationStart_ns);
}

/// A round number of millimetres above `largest_mm`.
double Top(double largest_mm) {
  for (double top = 4.0;; top *= 2.0)
    if (top >= largest_mm || top > 1e4) return top;
}

const char* ColourOf(Reaction reaction) {
  switch (reaction) {
    case Reaction::kLimit:
      return "#d9b13b";
    case Reaction::kHold:
      return "#d5652f";
    case Reaction::kFault:
      return "#a3132b";
    default:
      return "#b9d8c4";
  }
}

/// One run's plot with its left upper corner at the origin.
std::string PlotOf(const Trace& trace) {
  const auto& updates = trace.result.updates;
  const double end_s = std::max(1e-3, TimeOf(updates.back()));
  double largest_mm = 1e3 * trace.limits.deviation_m;
  for (const LoopUpdate& update : updates)
    largest_mm =
        std::max(largest_mm, std::isfinite(update.deviation_m) ? 1e3 * update.deviation_m : 0.0);
  const double top_mm = Top(largest_mm);
  const auto x = [&](double t_s) { return kLeft + kPlotWidth * std::clamp(t_s / end_s, 0.0, 1.0); };
  const auto y = [&](double mm) {
    return kTop + kPlotHeight * (1.0 - std::clamp(mm / top_mm, 0.0, 1.0));
  };
  std::string svg = fmt::format(
      "<text x='{}' y='16'>run {}: {} {}</text><text x='{}' y='32' fill='#666'>{}</text>\n", kLeft,
      trace.run.number, trace.run.FaultText(), SizeName(trace.run.size), kLeft,
      trace.run.base.Text());
  for (const simulation::Fault& fault : trace.run.faults) {
    const double width = std::max(2.0, x(fault.start_s + fault.duration_s) - x(fault.start_s));
    svg += fmt::format("<rect x='{:.1f}' y='{}' width='{:.1f}' height='{:.1f}' fill='#f6dede'/>\n",
                       x(fault.start_s), kTop, width, kPlotHeight);
  }
  svg += fmt::format(
      "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#c33' stroke-dasharray='4 3'/>"
      "<text x='{3}' y='{4}' text-anchor='end'>{5:.0f} mm</text>"
      "<text x='{3}' y='{6:.1f}' text-anchor='end'>0</text>"
      "<text x='{1}' y='{7}' text-anchor='end'>{8:.1f} s</text>\n",
      kLeft, kLeft + kPlotWidth, y(1e3 * trace.limits.deviation_m), kLeft - 4, kTop + 6, top_mm,
      kTop + kPlotHeight, kHeight - 4, end_s);
  std::string line, strips;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    const double t_s = TimeOf(updates[i]);
    line += fmt::format("{:.1f},{:.1f} ", x(t_s), y(1e3 * updates[i].deviation_m));
    const double next_s = i + 1 < updates.size() ? TimeOf(updates[i + 1]) : end_s;
    strips += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.2f}' height='{}' fill='{}'/>",
                          x(t_s), kTop + kPlotHeight + 6, x(next_s) - x(t_s) + 0.2, kStrip,
                          ColourOf(updates[i].supervision.reaction));
  }
  svg += fmt::format("<polyline points='{}' fill='none' stroke='#23507f' stroke-width='1.5'/>\n",
                     line);
  return svg + strips + "\n";
}

}  // namespace

Trace TraceRun(FaultRun run, SupervisionKind kind, Twins& twins) {
  const Twin& twin = twins.Of(run.base);
  const simulation::LoopSetup setup = FaultedSetup(twin, run);
  return {run, kind, twin.limits,
          RunClosedLoop(Supervised(setup, run.base.move, twin.limits.deviation_m, kind), nullptr)};
}

Trace TraceHealthyRun(std::uint64_t first_seed, int number, SupervisionKind kind) {
  const HealthyRun healthy = DrawHealthyRun(first_seed, number);
  Trace trace;
  trace.run.number = number;
  trace.run.base = healthy.base;
  trace.kind = kind;
  const double deviation_m = RunClosedLoop(healthy.setup, nullptr).max_deviation_m;
  trace.limits.deviation_m = DeviationLimitOf(deviation_m);
  trace.result = RunClosedLoop(
      Supervised(healthy.setup, healthy.base.move, trace.limits.deviation_m, kind), nullptr);
  return trace;
}

std::string TraceCsv(const Trace& trace) {
  std::string text =
      "t_s,deviation_mm,status,stop,reaction,voted_out,chi2,chi2_limit,worst_angle_deg,tip_force_N,"
      "tip_error_mm,px_m,py_m,pz_m,cx_m,cy_m,cz_m,gx_m,gy_m,gz_m\n";
  for (const LoopUpdate& update : trace.result.updates) {
    const Supervision& found = update.supervision;
    const double error_mm = update.tip ? 1e3 * (update.tip->p_RE - update.p_RE).norm() : NAN;
    text += fmt::format("{:.4f},{:.4f},{},{},{},{},{:.1f},{:.1f},{:.1f},{:.4f},{:.4f}",
                        TimeOf(update), 1e3 * update.deviation_m, flextip::Name(update.status),
                        flextip::Name(found.stop), flextip::Name(found.reaction), found.voted_out,
                        found.chi2, found.chi2_limit, 57.29578 * found.worst_angle_rad,
                        update.f_tip_N.norm(), error_mm);
    for (const Eigen::Vector3d& p : {update.p_RW, update.p_RW_command, update.p_RE_desired})
      text += fmt::format(",{:.6f},{:.6f},{:.6f}", p.x(), p.y(), p.z());
    text += '\n';
  }
  return text;
}

std::string TracesSvg(const std::vector<Trace>& traces) {
  const int rows = (static_cast<int>(traces.size()) + kColumns - 1) / kColumns;
  const int columns = std::min<int>(kColumns, static_cast<int>(traces.size()));
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{}' height='{}' font-family='sans-serif' "
      "font-size='11'>\n<rect width='100%' height='100%' fill='#fff'/>\n"
      "<text x='{}' y='18' font-size='13'>Tip off its path; dashed: a hazard from there on; "
      "shaded: "
      "the fault</text>\n",
      kWidth * std::max(columns, 2), 56 + kHeight * rows, kLeft);
  int x = kLeft;
  for (const Reaction reaction :
       {Reaction::kNone, Reaction::kLimit, Reaction::kHold, Reaction::kFault}) {
    svg += fmt::format(
        "<rect x='{}' y='30' width='12' height='10' fill='{}'/><text x='{}' y='39'>{}"
        "</text>\n",
        x, ColourOf(reaction), x + 16,
        reaction == Reaction::kNone ? "goes on" : flextip::Name(reaction));
    x += 80;
  }
  for (std::size_t i = 0; i < traces.size(); ++i) {
    const int column = static_cast<int>(i) % kColumns, row = static_cast<int>(i) / kColumns;
    svg += fmt::format("<g transform='translate({},{})'>\n{}</g>\n", kWidth * column,
                       50 + kHeight * row, PlotOf(traces[i]));
  }
  return svg + "</svg>\n";
}

}  // namespace flextip::bench
