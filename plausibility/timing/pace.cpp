#include "plausibility/timing/pace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace flextip::plausibility {
namespace {

/// Returns whether `other` has at least half the samples that its rate promises between both times.
bool GoesOn(const Rows& other, TimeNs from_ns, TimeNs to_ns) {
  const auto first = std::upper_bound(other.t_ns.begin(), other.t_ns.end(), from_ns);
  const auto last = std::lower_bound(first, other.t_ns.end(), to_ns);
  const double expected = SecondsBetween(from_ns, to_ns) / MedianStep_s(other);
  return last - first >= 3 && static_cast<double>(last - first) >= 0.5 * expected;
}

std::optional<Finding> GapOf(const Rows& rows, const std::vector<Rows>& all) {
  if (rows.t_ns.size() < 6) return {};
  constexpr double kLeast_s = 0.4, kSteps = 5.0, kShare = 0.05;
  const double duration_s = SecondsBetween(rows.t_ns.front(), rows.t_ns.back());
  const double least_s =
      std::max(std::min(kLeast_s, kShare * duration_s), kSteps * MedianStep_s(rows));
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i) {
    const TimeNs from = rows.t_ns[i - 1], to = rows.t_ns[i];
    if (SecondsBetween(from, to) < least_s) continue;
    for (const Rows& other : all) {
      if (other.name == rows.name || other.t_ns.size() < 6 || !GoesOn(other, from, to)) continue;
      return Finding{
          Severity::kDoubtful, rows.name + ".gap",
          fmt::format("{}: no samples for {} from {:.2f} s of the recording on, while {} goes on",
                      rows.name, DurationText(SecondsBetween(from, to)),
                      SecondsBetween(rows.t_ns.front(), from), other.name),
          "cut the recording there, or record again"};
    }
  }
  return {};
}

}  // namespace

std::vector<Finding> CheckRates(const std::vector<Rows>& rows) {
  constexpr double kMost = 1.15;
  std::vector<Finding> findings;
  for (const Rows& r : rows) {
    if (r.t_ns.size() < 6 || !(r.stated_rate_hz > 0.0)) continue;
    // A sensor that is read by a loop of another rate has uneven steps of the right mean.
    const double rate = 1.0 / MedianStep_s(r);
    const double mean =
        static_cast<double>(r.t_ns.size() - 1) / SecondsBetween(r.t_ns.front(), r.t_ns.back());
    const auto is_stated = [&](double x) {
      return std::abs(std::log(x / r.stated_rate_hz)) < std::log(kMost);
    };
    if (is_stated(rate) || is_stated(mean)) continue;
    findings.push_back({Severity::kDoubtful, r.name + ".rate",
                        fmt::format("{}: {:.4g} samples a second, the file states {:.4g}", r.name,
                                    rate, r.stated_rate_hz),
                        fmt::format("rate_hz: {:.4g} in {}/sensor.yaml", rate, r.name)});
  }
  return findings;
}

std::vector<Finding> CheckGaps(const std::vector<Rows>& rows) {
  std::vector<Finding> findings;
  for (const Rows& r : rows) {
    if (auto gap = GapOf(r, rows)) findings.push_back(std::move(*gap));
  }
  return findings;
}

}  // namespace flextip::plausibility
