#include "plausibility/timing/time_units.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "core/median.h"

namespace flextip::plausibility {
namespace {

struct TimeUnit {
  double factor;  ///< to nanoseconds
  const char* name;
};

/// The unit whose steps have the stated rate, or the other streams' duration, where those of
/// nanoseconds do not.
std::optional<TimeUnit> OtherTimeUnit(const Rows& rows, double usual_duration_s) {
  if (rows.t_ns.size() < 3) return {};
  const double duration = SecondsBetween(rows.t_ns.front(), rows.t_ns.back());
  const double ratio = rows.stated_rate_hz > 0.0 ? 1.0 / (rows.stated_rate_hz * MedianStep_s(rows))
                                                 : usual_duration_s / std::max(1e-12, duration);
  for (const TimeUnit unit : {TimeUnit{1e3, "microseconds"}, TimeUnit{1e6, "milliseconds"},
                              TimeUnit{1e-3, "picoseconds"}, TimeUnit{1e9, "seconds"}}) {
    if (std::abs(std::log(ratio / unit.factor)) < std::log(3.0)) return unit;
  }
  return {};
}

template <class T>
void Scale(Series<T>& series, double factor) {
  constexpr long double kMost = 9.2e18L;  // of 64 bits
  for (Sample<T>& sample : series) {
    const long double t = static_cast<long double>(sample.t_ns) * static_cast<long double>(factor);
    if (std::abs(t) < kMost) sample.t_ns = static_cast<TimeNs>(t);
  }
}

void ScaleTimes(Recording& r, const std::string& name, double factor) {
  if (name == "wrist0") Scale(r.wrist0->samples, factor);
  if (name == "command0") Scale(r.command0->p_RW, factor);
  if (name == "em0") Scale(r.em0->samples, factor);
  if (name == "em1") Scale(r.em1->samples, factor);
  if (name == "strain0") Scale(r.strain0->moments_Nm, factor);
  if (name == "load0") Scale(r.load0->f_tip_N, factor);
  if (name == "vision0") Scale(r.vision0->tips, factor);
  if (name == "cam0") {
    Scale(r.cam0->filenames, factor);
    Scale(r.cam0->frame_numbers, factor);
  }
}

std::string Mend(const Rows& rows, const TimeUnit& unit) {
  if (unit.factor < 1.0) return fmt::format("divide its time stamps by {:.0e}", 1.0 / unit.factor);
  const char* option = unit.factor < 1e4 ? "us" : unit.factor < 1e7 ? "ms" : "s";
  return fmt::format("import with --unit {}={}, or multiply its time stamps by {:.0e}", rows.name,
                     option, unit.factor);
}

}  // namespace

std::vector<Finding> CheckTimeUnits(const std::vector<Rows>& rows, Recording& repaired) {
  std::vector<Finding> findings;
  std::vector<double> durations;
  for (const Rows& r : rows) {
    if (r.t_ns.size() > 2) durations.push_back(SecondsBetween(r.t_ns.front(), r.t_ns.back()));
  }
  const double usual_duration_s = Median(durations);
  for (const Rows& r : rows) {
    const auto unit = OtherTimeUnit(r, usual_duration_s);
    if (!unit) continue;
    const std::string stated =
        r.stated_rate_hz > 0.0 ? fmt::format(" in place of {:.3g}", r.stated_rate_hz) : "";
    findings.push_back(
        {Severity::kWrong, r.name + ".time_unit",
         fmt::format("{}: time stamps look like {}: as nanoseconds its {} samples last {}, and "
                     "follow each other at {:.3g} Hz{}",
                     r.name, unit->name, r.t_ns.size(),
                     DurationText(SecondsBetween(r.t_ns.front(), r.t_ns.back())),
                     1.0 / MedianStep_s(r), stated),
         Mend(r, *unit)});
    ScaleTimes(repaired, r.name, unit->factor);
  }
  return findings;
}

}  // namespace flextip::plausibility
