#include "calibration/verdict/clock.h"

#include <fmt/format.h>

#include <cmath>

namespace flextip {
namespace {

constexpr double kCoarse_s = 0.001;  // with more, slow motion was off by up to 14 deviations
constexpr double kSurely = 3.0;      // standard deviations

double Sd(const StreamClock& clock) { return std::sqrt(clock.covariance(0, 0)); }

std::string OffsetText(double offset_s) {
  return std::abs(offset_s) < 1.0 ? fmt::format("{:.2f} ms", 1e3 * std::abs(offset_s))
                                  : fmt::format("{:.4f} s", std::abs(offset_s));
}

/// "em0's clock is 1.2034 s behind wrist0's (± 0.2 ms)".
std::string Sentence(const StreamClock& clock) {
  const double sd_s = Sd(clock);
  if (std::abs(clock.offset_s) < kSurely * sd_s) {
    return fmt::format("{} and {} go together to {:.2g} ms", clock.stream, clock.reference,
                       1e3 * sd_s);
  }
  return fmt::format("{}'s clock is {} {} {}'s (± {:.2g} ms)", clock.stream,
                     OffsetText(clock.offset_s), clock.offset_s > 0.0 ? "behind" : "ahead of",
                     clock.reference, 1e3 * sd_s);
}

void AddReasons(const StreamClock& clock, CalibrationVerdict& verdict) {
  if (Sd(clock) > kCoarse_s) {
    verdict.Beware(fmt::format(
        "{}: known to {:.2g} ms only; in slow motion friction and loads can count as offset beyond "
        "that; move faster, or longer",
        clock.stream, 1e3 * Sd(clock)));
  }
  const double rate_sd = std::sqrt(clock.covariance(1, 1));
  if (std::abs(clock.rate) > kSurely * rate_sd) {
    verdict.Mention(fmt::format("{} runs {:.1f} ppm {} than {} (± {:.1f})", clock.stream,
                                1e6 * std::abs(clock.rate), clock.rate > 0.0 ? "slower" : "faster",
                                clock.reference, 1e6 * rate_sd),
                    false);
  }
  if (!clock.by.empty()) {
    verdict.Mention(
        fmt::format("{} was compared with {}, whose clock is known", clock.stream, clock.by),
        false);
  }
}

}  // namespace

CalibrationVerdict JudgeClocks(const ClockResult& result) {
  CalibrationVerdict verdict;
  std::string found;
  for (const StreamClock& clock : result.streams) {
    if (!clock.IsUsable()) {
      verdict.not_found.push_back({clock.stream + ".time_offset_s", clock.reason});
      continue;
    }
    found += (found.empty() ? "" : "; ") + Sentence(clock);
    verdict.Add(clock.stream + ", add to its times", fmt::format("{:.2f} ms", 1e3 * clock.offset_s),
                fmt::format("{:.2g} ms", 1e3 * Sd(clock)));
    verdict.Add(clock.stream + ", rate", fmt::format("{:.1f} ppm", 1e6 * clock.rate),
                fmt::format("{:.1f} ppm", 1e6 * std::sqrt(clock.covariance(1, 1))));
    AddReasons(clock, verdict);
  }
  if (found.empty()) {
    verdict.grade = Grade::kNotFound;
    verdict.says =
        fmt::format("No stream shares a motion with {} that tells its clock.", result.reference);
    verdict.next =
        "record a minute in which the instrument is moved by hand, fast and never twice the same, "
        "with all sensors on";
    return verdict;
  }
  verdict.says = found + ".";
  verdict.next = "give calibration.yaml to the commands that use the recording";
  verdict.command =
      "flextip estimate RECORDING --calibration RESULT/calibration.yaml -o RESULT-estimate";
  return verdict;
}

}  // namespace flextip
