#include "apps/control/figures.h"

#include <cmath>
#include <utility>

namespace flextip {
namespace {

constexpr double kShortest_s = 1e-5, kLongest_s = 0.1;
constexpr int kBinsPerDecade = 10;

/// The counts over bins of equal width in the logarithm; nothing where the duration was not taken.
report::FigureTrace Trace(const char* name, const live::Spread& spread) {
  report::FigureTrace trace;
  trace.name = name;
  if (spread.Count() == 0) return trace;
  const int bins =
      static_cast<int>(std::lround(kBinsPerDecade * std::log10(kLongest_s / kShortest_s)));
  const auto edge_s = [](int i) {
    return kShortest_s * std::pow(10.0, double(i) / kBinsPerDecade);
  };
  for (int i = 0; i < bins; ++i) {
    const long count = spread.Between(i == 0 ? 0.0 : edge_s(i), edge_s(i + 1));
    trace.x.push_back(1e3 * std::sqrt(edge_s(i) * edge_s(i + 1)));
    trace.y.push_back(count > 0 ? static_cast<double>(count) : std::nan(""));
  }
  return trace;
}

}  // namespace

std::vector<report::Figure> TimeFigures(const live::LoopReport& report) {
  report::Figure figure{.name = "times",
                        .title = "Times of the cycles",
                        .caption =
                            "How often each time occurred, ten bins for a factor of ten. "
                            "Times above 100 ms are not drawn.",
                        .x_label = "time (ms)",
                        .y_label = "cycles",
                        .log_x = true,
                        .log_y = true};
  const std::pair<const char*, const live::Spread*> spreads[] = {
      {"cycle due to begun", &report.wake},
      {"cycle begun to command sent", &report.work},
      {"wrist's sample to command sent", &report.sample_to_command}};
  for (const auto& [name, spread] : spreads) {
    report::FigureTrace trace = Trace(name, *spread);
    if (!trace.x.empty()) figure.traces.push_back(std::move(trace));
  }
  return {figure};
}

}  // namespace flextip
