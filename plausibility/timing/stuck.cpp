#include "plausibility/timing/stuck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/median.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

/// Neighbouring samples with the same values.
struct Run {
  std::size_t begin = 0, length = 1;
};

std::vector<Run> RunsOf(const Rows& rows) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < rows.values.size(); ++i) {
    if (i > 0 && !rows.values[i].empty() && rows.values[i] == rows.values[i - 1]) {
      ++runs.back().length;
    } else {
      runs.push_back({i, 1});
    }
  }
  return runs;
}

Vector3d PlaceAt(const Rows& rows, std::size_t i) {
  return {rows.values[i][0], rows.values[i][1], rows.values[i][2]};
}

/// Returns how far a stream's place gets between two times (m): medians of tenths of the time, so
/// that noise is no way.
double WayOf(const Rows& rows, TimeNs from_ns, TimeNs to_ns) {
  constexpr std::size_t kParts = 10;
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < rows.t_ns.size(); ++i) {
    if (rows.t_ns[i] >= from_ns && rows.t_ns[i] <= to_ns && rows.values[i].size() >= 3)
      inside.push_back(i);
  }
  if (inside.size() < 2) return 0.0;
  const std::size_t parts = std::min(kParts, inside.size());
  Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = part * inside.size() / parts;
    const std::size_t end = (part + 1) * inside.size() / parts;
    Vector3d middle;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (std::size_t k = begin; k < end; ++k) values.push_back(PlaceAt(rows, inside[k])[axis]);
      middle[axis] = Median(std::move(values));
    }
    low = low.cwiseMin(middle), high = high.cwiseMax(middle);
  }
  return (high - low).norm();
}

/// Returns how far another stream's place gets meanwhile (m). A wrist may rest while its tip is
/// pushed: only the command and a long way of the tip speak against it.
double MovedMeanwhile(const std::vector<Rows>& all, const Rows& resting, TimeNs from_ns,
                      TimeNs to_ns) {
  constexpr double kPushed = 4.0;  // a tip's way over the least way that counts
  double most = 0.0;
  for (const Rows& r : all) {
    if (r.name == resting.name) continue;
    if (r.name == "wrist0" || (r.name == "command0" && resting.name == "wrist0")) {
      most = std::max(most, WayOf(r, from_ns, to_ns));
    } else if (r.name == "em0" || r.name == "vision0") {
      const double way = WayOf(r, from_ns, to_ns);
      most = std::max(most, resting.name == "wrist0" ? way / kPushed : way);
    }
  }
  return most;
}

bool IsZero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return x == 0.0; });
}

/// Returns the length of runs that most of the samples are in, where that is two or more.
std::optional<std::size_t> UsualRepeat(const std::vector<Run>& runs, std::size_t samples) {
  std::map<std::size_t, std::size_t> in_runs_of;
  for (const Run& run : runs) in_runs_of[run.length] += run.length;
  const auto usual = std::max_element(in_runs_of.begin(), in_runs_of.end(),
                                      [](auto& a, auto& b) { return a.second < b.second; });
  const bool short_runs = usual->first * 4 <= samples, most = 2 * usual->second >= samples;
  if (usual->first < 2 || !short_runs || !most) return {};
  return usual->first;
}

/// Returns whether the rows outside of `longest` seldom repeat: values are measured, not stated.
bool VariesElsewhere(const std::vector<Run>& runs, const Run& longest) {
  std::size_t rows = 0, repeats = 0;
  for (const Run& run : runs) {
    if (run.begin == longest.begin) continue;
    rows += run.length, repeats += run.length - 1;
  }
  return 5 * repeats < rows;
}

/// Returns whether a sensor has noise that its numbers are fine enough to show: it never reads the
/// same twice.
bool ShowsNoise(const Rows& rows) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < rows.values.size(); ++i) {
    const double step = std::abs(rows.values[i][0] - rows.values[i - 1][0]);
    if (step > 0.0) least = std::min(least, step);
  }
  return least < rows.noise;
}

/// Returns whether a wrist is stuck, not at rest: it halts once, and from one sample to the next.
bool HaltsAtOnce(const Rows& rows, const std::vector<Run>& runs, const Run& longest) {
  constexpr double kBraked = 0.3;  // of the usual step: a robot brakes before it rests
  if (longest.begin < 2) return false;
  for (const Run& run : runs)
    if (run.begin != longest.begin && 2 * run.length > longest.length) return false;
  std::vector<double> steps;
  for (std::size_t i = 1; i <= longest.begin; ++i)
    steps.push_back((PlaceAt(rows, i) - PlaceAt(rows, i - 1)).norm());
  const double before = steps.back();
  return before > kBraked * Median(std::move(steps));
}

template <class T>
void KeepOf(Series<T>& series, const std::vector<char>& keep) {
  std::size_t i = 0;
  std::erase_if(series, [&](const Sample<T>&) { return keep[i++] == 0; });
}

void KeepRows(Recording& r, const std::string& name, const std::vector<char>& keep) {
  if (name == "wrist0") KeepOf(r.wrist0->samples, keep);
  if (name == "command0") KeepOf(r.command0->p_RW, keep);
  if (name == "em0") KeepOf(r.em0->samples, keep);
  if (name == "em1") KeepOf(r.em1->samples, keep);
  if (name == "strain0") KeepOf(r.strain0->moments_Nm, keep);
  if (name == "load0") KeepOf(r.load0->f_tip_N, keep);
  if (name == "vision0") KeepOf(r.vision0->tips, keep);
}

class StuckCheck {
 public:
  StuckCheck(const std::vector<Rows>& all, Recording& repaired) : all_(all), repaired_(repaired) {}

  void Check(const Rows& rows) {
    if (rows.values.size() < 12 || rows.name == "cam0") return;
    const std::vector<Run> runs = RunsOf(rows);
    const auto times = UsualRepeat(runs, rows.values.size());
    if (times && !rows.may_rest) {
      Repeated(rows, runs, *times);
    } else {
      Frozen(rows, runs);
    }
  }

  std::vector<Finding> findings;

 private:
  void Repeated(const Rows& rows, const std::vector<Run>& runs, std::size_t times) {
    const double rate = 1.0 / MedianStep_s(rows);
    findings.push_back(
        {Severity::kWrong, rows.name + ".repeated",
         fmt::format("{}: each value stands {} times in a row: the sensor has {:.3g} samples a "
                     "second, not {:.3g}",
                     rows.name, times, rate / static_cast<double>(times), rate),
         "keep the first of each run of equal rows"});
    std::vector<char> keep(rows.values.size(), 0);
    for (const Run& run : runs) keep[run.begin] = 1;
    KeepRows(repaired_, rows.name, keep);
  }

  void Frozen(const Rows& rows, const std::vector<Run>& runs) {
    constexpr std::size_t kFewest = 15, kFewestNoisy = 5;
    constexpr double kLongEnough_s = 0.5, kShare = 0.2, kWristMoved_m = 0.005, kMoved_m = 0.002;
    constexpr double kCommanded_m = 0.02;
    const Run longest = *std::max_element(
        runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.length < b.length; });
    if (rows.may_rest && IsZero(rows.values[longest.begin])) return;  // no load is a reading
    if (rows.may_rest && (runs.size() < 3 || !VariesElsewhere(runs, longest))) return;
    const std::size_t last = longest.begin + longest.length - 1;
    const TimeNs from = rows.t_ns[longest.begin], to = rows.t_ns[last];
    const bool noisy = rows.noise > 0.0 && ShowsNoise(rows) && VariesElsewhere(runs, longest);
    if (longest.length < (noisy ? kFewestNoisy : kFewest)) return;
    const double all_s = SecondsBetween(rows.t_ns.front(), rows.t_ns.back());
    if (SecondsBetween(from, to) <
        (noisy ? std::min(kLongEnough_s, kShare * all_s) : kLongEnough_s))
      return;
    const double moved = MovedMeanwhile(all_, rows, from, to);
    if (rows.name == "wrist0") {
      const Rows* command = FindRows(all_, "command0");
      const bool commanded = command != nullptr && WayOf(*command, from, to) > kCommanded_m;
      if (moved < kWristMoved_m || (!commanded && !HaltsAtOnce(rows, runs, longest))) return;
    } else if (moved < kMoved_m && !noisy) {
      return;
    }
    findings.push_back(
        {Severity::kWrong, rows.name + ".frozen",
         fmt::format("{}: stands still from {:.2f} s to {:.2f} s of the recording "
                     "({} equal rows) while the instrument moves by {:.0f} mm",
                     rows.name, SecondsBetween(rows.t_ns.front(), from),
                     SecondsBetween(rows.t_ns.front(), to), longest.length, 1e3 * moved),
         "remove these rows, or cut the recording there"});
    std::vector<char> keep(rows.values.size(), 1);
    std::fill(keep.begin() + static_cast<std::ptrdiff_t>(longest.begin + 1),
              keep.begin() + static_cast<std::ptrdiff_t>(last + 1), 0);
    KeepRows(repaired_, rows.name, keep);
  }

  const std::vector<Rows>& all_;
  Recording& repaired_;
};

}  // namespace

std::vector<Finding> CheckStuck(const std::vector<Rows>& rows, Recording& repaired) {
  StuckCheck check(rows, repaired);
  for (const Rows& r : rows) check.Check(r);
  return check.findings;
}

}  // namespace flextip::plausibility
