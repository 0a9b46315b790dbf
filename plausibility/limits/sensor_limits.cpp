#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/median.h"
#include "plausibility/limits/limits.h"

namespace flextip::plausibility {
namespace {

void Wrong(std::vector<Finding>& findings, const std::string& id, std::string text,
           std::string mend) {
  findings.push_back({Severity::kWrong, id, std::move(text), std::move(mend)});
}

std::string StationsText(double first, double second) {
  return fmt::format("stations_from_wrist_m: [{:.4g}, {:.4g}] in strain0/sensor.yaml", first,
                     second);
}

void CheckStations(Recording& recording, std::vector<Finding>& findings) {
  constexpr double kMillimetres = 30.0;  // shafts long
  const double length = recording.instrument.length_m;
  auto& s = recording.strain0->station_from_wrist_m;
  if (s[1] > kMillimetres * length) {
    Wrong(findings, "strain0.stations",
          fmt::format("strain0: the stations at {:.4g} and {:.4g} m look like millimetres", s[0],
                      s[1]),
          StationsText(1e-3 * s[0], 1e-3 * s[1]));
    s[0] *= 1e-3, s[1] *= 1e-3;
    return;
  }
  if (s[0] > 0.0 && s[1] < length && s[0] < s[1]) return;
  if (s[0] > s[1] && s[1] > 0.0 && s[0] < length) {
    Wrong(
        findings, "strain0.stations",
        fmt::format("strain0: the first station, at {:.4g} m, lies beyond the second, at {:.4g} m",
                    s[0], s[1]),
        StationsText(s[1], s[0]) + ", or exchange the columns as well");
    std::swap(s[0], s[1]);
    return;
  }
  Wrong(findings, "strain0.stations",
        fmt::format("strain0: the stations at {:.4g} and {:.4g} m do not lie on the shaft of "
                    "{:.4g} m",
                    s[0], s[1], length),
        "stations_from_wrist_m: distances from the wrist along the shaft, the nearer one first");
  recording.strain0.reset();
}

void CheckLoadSize(const Recording& recording, std::vector<Finding>& findings) {
  constexpr double kLargest_N = 100.0;
  std::vector<double> sizes;
  for (const auto& f : recording.load0->f_tip_N) sizes.push_back(f.value.norm());
  const double large = Quantile(std::move(sizes), 0.9);
  if (large < kLargest_N) return;
  // In mN more often than not. The relations to other sensors may say grams, and then replace this.
  Wrong(findings, "load0.large",
        fmt::format("load0: forces reach {:.4g} N, an instrument's tip has some N", large),
        "import with --unit load0=mN where the numbers are mN");
}

void CheckEmDistance(Recording& recording, std::vector<Finding>& findings) {
  const double length = recording.instrument.length_m;
  double& distance = recording.em0->distance_from_tip_m;
  if (distance >= 0.0 && distance <= length) return;
  const bool mm = distance > length && 1e-3 * distance < length;
  Wrong(findings, "em0.distance",
        fmt::format("em0: distance_from_tip_m: {:.4g} is beyond the shaft of {:.4g} m{}", distance,
                    length, mm ? ": it looks like millimetres" : ""),
        mm ? fmt::format("distance_from_tip_m: {:.4g} in em0/sensor.yaml", 1e-3 * distance) : "");
  if (mm) distance *= 1e-3;
}

}  // namespace

void CheckSensors(const std::set<std::string>& unknown, Recording& recording,
                  std::vector<Finding>& findings) {
  if (recording.strain0 && !unknown.contains("length")) CheckStations(recording, findings);
  if (recording.load0 && !recording.load0->f_tip_N.empty()) CheckLoadSize(recording, findings);
  if (recording.em0 && !unknown.contains("length")) CheckEmDistance(recording, findings);
}

}  // namespace flextip::plausibility
