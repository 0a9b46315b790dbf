#include "apps/align/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "calibration/clock/smooth_motion.h"

namespace flextip {
namespace {

constexpr const char *kReference = "#56606b", *kBefore = "#d55e00", *kAfter = "#0072b2";
constexpr double kBandwidth_s = 0.12, kShown_s = 30.0;
constexpr int kPoints = 600;

/// A speed over time, as part of its RMS: quantities of any unit side by side.
report::FigureTrace SpeedTrace(const Motion& motion, const std::string& name,
                               const std::string& color, double from_s, double to_s,
                               const std::function<double(double)>& own_time) {
  const SmoothMotion smooth(motion, std::max(kBandwidth_s, UsualBandwidth(motion)));
  report::FigureTrace trace{.name = name, .color = color};
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const double t_s = from_s + (to_s - from_s) * i / kPoints;
    const double speed = smooth.SpeedAt(own_time(t_s), motion.own_rows);
    trace.x.push_back(t_s);
    trace.y.push_back(speed);
    if (std::isnan(speed)) continue;
    squares += speed * speed;
    ++count;
  }
  const double rms = count > 0 && squares > 0.0 ? std::sqrt(squares / count) : 1.0;
  for (double& y : trace.y) y /= rms;
  return trace;
}

report::Figure SpeedFigure(const Motion& target, const Motion& reference, const StreamClock& clock,
                           bool after, double from_s, double to_s, TimeNs epoch_ns) {
  const double origin_s = 1e-9 * static_cast<double>(clock.origin_ns - epoch_ns);
  const auto own_time = [&](double t_s) {
    if (!after) return t_s;
    return (t_s - clock.offset_s + clock.rate * origin_s) / (1.0 + clock.rate);
  };
  const auto same = [](double t_s) { return t_s; };
  return {.name = fmt::format("{}-{}", target.stream, after ? "after" : "before"),
          .title = fmt::format("{} and {}, {}", target.stream, reference.stream,
                               after ? "aligned" : "as recorded"),
          .caption = fmt::format("Speed of the {} and of the {}, each over its RMS.",
                                 target.quantity, reference.quantity),
          .x_label = "time (s)",
          .y_label = "speed over its RMS",
          .traces = {
              SpeedTrace(reference, reference.stream, kReference, from_s, to_s, same),
              SpeedTrace(target, target.stream, after ? kAfter : kBefore, from_s, to_s, own_time)}};
}

report::Figure MisfitFigure(const StreamClock& clock) {
  report::Figure figure{
      .name = clock.stream + "-misfit",
      .title = fmt::format("{}: how well each offset fits", clock.stream),
      .caption = "Part of the stream's motion that the reference does not predict at an offset.",
      .x_label = "offset (s)",
      .y_label = "misfit (%)"};
  report::FigureTrace trace{.name = "", .color = kAfter};
  trace.x = clock.profile.offset_s;
  for (const double m : clock.profile.misfit) trace.y.push_back(100.0 * m);
  figure.traces = {trace};
  if (clock.IsUsable() && clock.by.empty()) {
    figure.bands = {{clock.offset_s, clock.offset_s, kReference}};
  }
  return figure;
}

}  // namespace

nlohmann::json ClockSummary(const ClockResult& result) {
  nlohmann::json streams = nlohmann::json::array();
  for (const StreamClock& clock : result.streams) {
    nlohmann::json row{{"stream", clock.stream},
                       {"status", Name(clock.status)},
                       {"reason", clock.reason},
                       {"compared_with", clock.by.empty() ? clock.reference : clock.by}};
    if (clock.IsUsable()) {
      row.update({{"offset_s", clock.offset_s},
                  {"offset_standard_deviation_s", std::sqrt(clock.covariance(0, 0))},
                  {"rate", clock.rate},
                  {"rate_standard_deviation", std::sqrt(clock.covariance(1, 1))},
                  {"misfit", clock.misfit},
                  {"samples", clock.samples}});
    }
    streams.push_back(row);
  }
  return {{"reference", result.reference}, {"streams", streams}};
}

std::vector<report::Figure> ClockFigures(const Recording& recording, const ClockResult& result) {
  const Motions motions = MotionsOf(recording);
  std::vector<report::Figure> figures;
  for (const StreamClock& clock : result.streams) {
    const Motion& target = *motions.Find(clock.stream);
    const Motion& reference = *motions.Find(clock.by.empty() ? result.reference : clock.by);
    const double middle_s = 0.5 * (reference.t_s.front() + reference.t_s.back());
    const double half_s = 0.5 * std::min(kShown_s, reference.t_s.back() - reference.t_s.front());
    const auto speeds = [&](bool after) {
      return SpeedFigure(target, reference, clock, after, middle_s - half_s, middle_s + half_s,
                         motions.epoch_ns);
    };
    if (clock.IsUsable() && clock.by.empty()) {
      figures.push_back(speeds(false));
      figures.push_back(speeds(true));
    }
    figures.push_back(MisfitFigure(clock));
  }
  return figures;
}

}  // namespace flextip
