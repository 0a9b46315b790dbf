#include "plausibility/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "core/median.h"
#include "plausibility/relations.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

template <class T>
double Seconds(T from_ns, T to_ns) {
  return 1e-9 * static_cast<double>(to_ns - from_ns);
}

template <class T, class Values>
Rows MakeRows(const std::string& name, double rate_hz, const Series<T>& series, Values values_of) {
  Rows rows{name, rate_hz, {}, {}, false};
  for (const Sample<T>& sample : series) {
    rows.t_ns.push_back(sample.t_ns);
    rows.values.push_back(values_of(sample.value));
  }
  return rows;
}

template <class Vector>
std::vector<double> Numbers(const Vector& v) {
  return {v.data(), v.data() + v.size()};
}

std::vector<double> Numbers(const Vector3d& p, const Eigen::Quaterniond& q) {
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

const Rows* Find(const std::vector<Rows>& rows, const std::string& name) {
  for (const Rows& r : rows)
    if (r.name == name) return &r;
  return nullptr;
}

double MedianStep_s(const Rows& rows) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i)
    steps.push_back(Seconds(rows.t_ns[i - 1], rows.t_ns[i]));
  return Median(steps);
}

std::string Duration(double s) {
  const double a = std::abs(s);
  if (a >= 2.0 * 86400.0 * 365.0) return fmt::format("{:.1f} years", s / (86400.0 * 365.25));
  if (a >= 2.0 * 86400.0) return fmt::format("{:.1f} days", s / 86400.0);
  if (a >= 3600.0) return fmt::format("{:.2f} h", s / 3600.0);
  if (a >= 1.0) return fmt::format("{:.2f} s", s);
  if (a >= 1e-3) return fmt::format("{:.0f} ms", 1e3 * s);
  return fmt::format("{:.3g} us", 1e6 * s);
}

// ---- times in another unit -------------------------------------------------------------------

struct TimeUnit {
  double factor;
  const char* name;
};

/// The unit whose steps have the stated rate (or the wrist's length), where nanoseconds do not.
std::optional<TimeUnit> OtherTimeUnit(const Rows& rows, double usual_duration_s) {
  if (rows.t_ns.size() < 3) return {};
  const double step = MedianStep_s(rows);
  const double expected = rows.stated_rate_hz > 0.0 ? 1.0 / rows.stated_rate_hz : 0.0;
  const double ratio =
      expected > 0.0
          ? expected / step
          : usual_duration_s / std::max(1e-12, Seconds(rows.t_ns.front(), rows.t_ns.back()));
  for (const TimeUnit unit : {TimeUnit{1e3, "microseconds"}, TimeUnit{1e6, "milliseconds"},
                              TimeUnit{1e-3, "picoseconds"}, TimeUnit{1e9, "seconds"}}) {
    if (std::abs(std::log(ratio / unit.factor)) < std::log(3.0)) return unit;
  }
  return {};
}

template <class T>
void Scale(Series<T>& series, double factor) {
  for (Sample<T>& sample : series) {
    const long double t = static_cast<long double>(sample.t_ns) * static_cast<long double>(factor);
    if (std::abs(t) < 9.2e18L) sample.t_ns = static_cast<TimeNs>(t);
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

// ---- stuck values ----------------------------------------------------------------------------

/// Runs of samples with the same values: where they begin, and how many samples they have.
std::vector<std::pair<std::size_t, std::size_t>> Runs(const Rows& rows) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t i = 0; i < rows.values.size(); ++i) {
    if (i > 0 && !rows.values[i].empty() && rows.values[i] == rows.values[i - 1]) {
      ++runs.back().second;
    } else {
      runs.emplace_back(i, 1);
    }
  }
  return runs;
}

/// How far another stream's place moved between two times (m): 0 where none shows.
double MovedMeanwhile(const std::vector<Rows>& rows, const std::string& but, TimeNs from,
                      TimeNs to) {
  double most = 0.0;
  for (const Rows& r : rows) {
    if (r.name == but || (r.name != "wrist0" && r.name != "em0" && r.name != "vision0")) continue;
    Vector3d low = Vector3d::Constant(1e300), high = Vector3d::Constant(-1e300);
    double noise_steps = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < r.t_ns.size(); ++i) {
      if (r.t_ns[i] < from || r.t_ns[i] > to || r.values[i].size() < 3) continue;
      const Vector3d p(r.values[i][0], r.values[i][1], r.values[i][2]);
      low = low.cwiseMin(p), high = high.cwiseMax(p);
      if (i > 0 && r.values[i] != r.values[i - 1]) noise_steps += 1.0;
      ++count;
    }
    if (count > 1 && noise_steps > 0.0) most = std::max(most, (high - low).norm());
  }
  return most;
}

/// Returns which rows are worth something: not those that only repeat.
std::vector<char> CheckStuck(const Rows& rows, const std::vector<Rows>& all,
                             std::vector<Finding>& findings) {
  std::vector<char> keep(rows.values.size(), 1);
  if (rows.values.size() < 20 || rows.name == "cam0") return keep;
  const auto runs = Runs(rows);
  const std::size_t n = rows.values.size();
  std::size_t repeated = 0, longest = 0, longest_at = 0;
  std::map<std::size_t, std::size_t> in_runs_of;
  for (const auto& [begin, length] : runs) {
    if (length > 1) repeated += length;
    in_runs_of[length] += length;
    if (length > longest) longest = length, longest_at = begin;
  }
  const auto usual = std::max_element(in_runs_of.begin(), in_runs_of.end(),
                                      [](auto& a, auto& b) { return a.second < b.second; });
  if (usual->first >= 2 && usual->first * 8 <= n && 10 * usual->second >= 5 * n) {
    findings.push_back(
        {Severity::kWrong, rows.name + ".repeated",
         fmt::format("{}: each value stands {} times in a row: the sensor has {:.3g} samples a "
                     "second, not {:.3g}",
                     rows.name, usual->first,
                     1.0 / (MedianStep_s(rows) * static_cast<double>(usual->first)),
                     1.0 / MedianStep_s(rows)),
         "keep the first of each run of equal rows"});
    for (const auto& [begin, length] : runs)
      for (std::size_t i = 1; i < length; ++i) keep[begin + i] = 0;
    return keep;
  }
  if (rows.may_rest && (runs.size() < 3 || longest == n)) return keep;  // a constant load
  const TimeNs from = rows.t_ns[longest_at], to = rows.t_ns[longest_at + longest - 1];
  if (longest < 15 || Seconds(from, to) < 0.5) return keep;
  if (rows.may_rest) {  // zero, or all alike, is a reading
    const auto& v = rows.values[longest_at];
    if (std::all_of(v.begin(), v.end(), [](double x) { return x == 0.0; })) return keep;
  }
  constexpr double kMoved_m = 0.005;
  const double moved = MovedMeanwhile(all, rows.name, from, to);
  if (moved < kMoved_m) return keep;
  findings.push_back({Severity::kWrong, rows.name + ".frozen",
                      fmt::format("{}: stands still from {:.2f} s to {:.2f} s of the recording "
                                  "({} equal rows) while the instrument moves by {:.0f} mm",
                                  rows.name, Seconds(rows.t_ns.front(), from),
                                  Seconds(rows.t_ns.front(), to), longest, 1e3 * moved),
                      "remove these rows"});
  std::fill_n(keep.begin() + static_cast<std::ptrdiff_t>(longest_at + 1), longest - 1, 0);
  return keep;
}

template <class T>
void Keep(Series<T>& series, const std::vector<char>& keep) {
  std::size_t i = 0;
  std::erase_if(series, [&](const Sample<T>&) { return keep[i++] == 0; });
}

void KeepRows(Recording& r, const std::string& name, const std::vector<char>& keep) {
  if (std::all_of(keep.begin(), keep.end(), [](char k) { return k != 0; })) return;
  if (name == "wrist0") Keep(r.wrist0->samples, keep);
  if (name == "command0") Keep(r.command0->p_RW, keep);
  if (name == "em0") Keep(r.em0->samples, keep);
  if (name == "em1") Keep(r.em1->samples, keep);
  if (name == "strain0") Keep(r.strain0->moments_Nm, keep);
  if (name == "load0") Keep(r.load0->f_tip_N, keep);
  if (name == "vision0") Keep(r.vision0->tips, keep);
}

// ---- rates and gaps --------------------------------------------------------------------------

void CheckRate(const Rows& rows, std::vector<Finding>& findings) {
  if (rows.t_ns.size() < 6 || !(rows.stated_rate_hz > 0.0)) return;
  const double rate = 1.0 / MedianStep_s(rows);
  if (std::abs(std::log(rate / rows.stated_rate_hz)) < std::log(1.15)) return;
  findings.push_back({Severity::kDoubtful, rows.name + ".rate",
                      fmt::format("{}: {:.4g} samples a second, the file states {:.4g}", rows.name,
                                  rate, rows.stated_rate_hz),
                      fmt::format("rate_hz: {:.4g} in {}/sensor.yaml", rate, rows.name)});
}

/// A gap of one stream alone: where all pause, the recording was paused.
void CheckGap(const Rows& rows, const std::vector<Rows>& all, std::vector<Finding>& findings) {
  if (rows.t_ns.size() < 6) return;
  const double step = MedianStep_s(rows);
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i) {
    const TimeNs from = rows.t_ns[i - 1], to = rows.t_ns[i];
    const double gap = Seconds(from, to);
    if (gap < std::max(0.4, 10.0 * step)) continue;
    for (const Rows& other : all) {
      if (other.name == rows.name || other.t_ns.size() < 6) continue;
      const auto first = std::upper_bound(other.t_ns.begin(), other.t_ns.end(), from);
      const auto last = std::lower_bound(first, other.t_ns.end(), to);
      const double expected = gap / MedianStep_s(other);
      if (static_cast<double>(last - first) < 0.5 * expected || last - first < 3) continue;
      findings.push_back(
          {Severity::kDoubtful, rows.name + ".gap",
           fmt::format("{}: no samples for {} from {:.2f} s of the recording on, while {} goes on",
                       rows.name, Duration(gap), Seconds(rows.t_ns.front(), from), other.name),
           "cut the recording there, or record again"});
      return;
    }
  }
}

// ---- clocks ----------------------------------------------------------------------------------

double Overlap(const Rows& a, const Rows& b, double shift_s) {
  const double from = std::max(Seconds(b.t_ns.front(), a.t_ns.front()) + shift_s, 0.0);
  const double to = std::min(Seconds(b.t_ns.front(), a.t_ns.back()) + shift_s,
                             Seconds(b.t_ns.front(), b.t_ns.back()));
  const double shorter =
      std::min(Seconds(a.t_ns.front(), a.t_ns.back()), Seconds(b.t_ns.front(), b.t_ns.back()));
  if (!(shorter > 0.0)) return to >= from ? 1.0 : 0.0;
  return std::max(0.0, to - from) / shorter;
}

Finding ClockFinding(const std::string& name, double late_s, const std::string& how) {
  return {Severity::kWrong, name + ".clock",
          fmt::format("{}: its clock is {} {} that of the other streams ({})", name,
                      Duration(std::abs(late_s)), late_s > 0.0 ? "ahead of" : "behind", how),
          fmt::format("import with --clock {}={:.9g}s, or {} {} to its time stamps", name, -late_s,
                      late_s > 0.0 ? "subtract" : "add", Duration(std::abs(late_s)))};
}

// ---- lags ------------------------------------------------------------------------------------

using VectorAt = std::function<std::optional<Eigen::VectorXd>(TimeNs)>;

struct Lag {
  double seconds = 0.0, correlation = 0.0, correlation_at_zero = 0.0;
};

double Correlation(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b) {
  Eigen::VectorXd mean_a = Eigen::VectorXd::Zero(a[0].size()), mean_b = mean_a;
  for (std::size_t i = 0; i < a.size(); ++i) mean_a += a[i], mean_b += b[i];
  mean_a /= static_cast<double>(a.size()), mean_b /= static_cast<double>(a.size());
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a).dot(b[i] - mean_b);
    aa += (a[i] - mean_a).squaredNorm();
    bb += (b[i] - mean_b).squaredNorm();
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

/// Returns the shift of b's time (b at t + shift goes with a at t) of the best correlation.
std::optional<Lag> FindLag(const std::vector<TimeNs>& times, const VectorAt& a, const VectorAt& b,
                           double around_s, double reach_s, double step_s) {
  std::vector<std::pair<TimeNs, Eigen::VectorXd>> known;
  for (const TimeNs t : times) {
    if (auto value = a(t)) known.emplace_back(t, std::move(*value));
  }
  if (known.size() < 30) return {};
  const auto at = [&](double shift_s) -> std::optional<double> {
    std::vector<Eigen::VectorXd> x, y;
    const TimeNs shift = static_cast<TimeNs>(std::llround(shift_s * 1e9));
    for (const auto& [t, value] : known) {
      auto other = b(t + shift);
      if (!other) continue;
      x.push_back(value);
      y.push_back(std::move(*other));
    }
    if (x.size() < 30 || 2 * x.size() < known.size()) return {};
    return Correlation(x, y);
  };
  std::optional<Lag> best;
  for (double shift = around_s - reach_s; shift <= around_s + reach_s; shift += step_s) {
    const auto c = at(shift);
    if (c && (!best || *c > best->correlation)) best = Lag{shift, *c, 0.0};
  }
  if (best) best->correlation_at_zero = at(0.0).value_or(-1.0);
  return best;
}

std::vector<TimeNs> WristTimes(const Recording& r, std::size_t most) {
  std::vector<TimeNs> times;
  const auto& samples = r.wrist0->samples;
  const std::size_t count = std::min(most, samples.size());
  for (std::size_t k = 0; k < count; ++k)
    times.push_back(samples[k * (samples.size() - 1) / std::max<std::size_t>(1, count - 1)].t_ns);
  return times;
}

using PlaceAt = std::function<std::optional<Vector3d>(TimeNs)>;

/// Speed over 0.2 s: the same in every frame.
VectorAt SpeedOf(const PlaceAt& place) {
  return [place](TimeNs t) -> std::optional<Eigen::VectorXd> {
    constexpr TimeNs kHalf_ns = 100'000'000;
    const auto before = place(t - kHalf_ns), after = place(t + kHalf_ns);
    if (!before || !after) return {};
    return Eigen::VectorXd(Eigen::VectorXd::Constant(1, (*after - *before).norm()));
  };
}

PlaceAt PlaceOf(const Recording& r, const std::string& stream) {
  return [&r, stream](TimeNs t) -> std::optional<Vector3d> {
    const Instant now = InstantAt(r, t);
    if (stream == "em0" && now.em0) return now.em0->p;
    if (stream == "em1" && now.em1) return now.em1->p;
    if (stream == "vision0" && now.tip) return now.tip->p;
    if (stream == "command0" && now.command) return now.command;
    return {};
  };
}

/// Where the straight shaft has the stream's place.
PlaceAt ExpectedPlace(const Recording& r, const std::string& stream) {
  return [&r, stream](TimeNs t) -> std::optional<Vector3d> {
    const Instant now = InstantAt(r, t);
    if (!now.wrist) return {};
    if (stream == "command0") return now.wrist->p;
    const Vector3d to_port = r.p_RP - now.wrist->p;
    const double s = stream == "em0" ? r.instrument.length_m - r.em0->distance_from_tip_m
                                     : r.instrument.length_m;
    return Vector3d(now.wrist->p + s * to_port.normalized());
  };
}

bool MotionIsResolved(const Recording& r) {
  if (!r.wrist0 || r.wrist0->samples.size() < 60) return false;
  const auto& s = r.wrist0->samples;
  const double duration = Seconds(s.front().t_ns, s.back().t_ns);
  return duration > 3.0 && static_cast<double>(s.size()) / duration > 5.0;
}

/// The clock shift by speeds about `around_s`, where motion tells it.
std::optional<Lag> LagBySpeed(const Recording& r, const std::string& stream, double around_s) {
  if (!MotionIsResolved(r)) return {};
  const auto times = WristTimes(r, 250);
  const auto expected = SpeedOf(ExpectedPlace(r, stream)), found = SpeedOf(PlaceOf(r, stream));
  auto lag = FindLag(times, expected, found, around_s, 6.0, 0.1);
  if (!lag) return {};
  const double zero = lag->correlation_at_zero;
  lag = FindLag(times, expected, found, lag->seconds, 0.1, 0.02);
  if (lag) lag->correlation_at_zero = zero;
  return lag;
}

}  // namespace

std::vector<Rows> RowsOf(const Recording& r) {
  std::vector<Rows> all;
  if (r.wrist0) {
    all.push_back(MakeRows("wrist0", r.wrist0->rate_hz, r.wrist0->samples, [](const auto& s) {
      return s.q_RW ? Numbers(s.p_RW, *s.q_RW) : Numbers(s.p_RW);
    }));
  }
  if (r.command0) {
    all.push_back(MakeRows("command0", r.command0->rate_hz, r.command0->p_RW,
                           [](const auto& p) { return Numbers(p); }));
    all.back().may_rest = true;
  }
  const auto em = [&](const char* name, const std::optional<EmStream>& stream) {
    if (!stream) return;
    all.push_back(MakeRows(name, stream->rate_hz, stream->samples,
                           [](const auto& s) { return Numbers(s.p_RS, s.q_RS); }));
  };
  em("em0", r.em0);
  em("em1", r.em1);
  if (r.strain0) {
    all.push_back(MakeRows("strain0", r.strain0->rate_hz, r.strain0->moments_Nm,
                           [](const auto& m) { return Numbers(m); }));
  }
  if (r.load0) {
    all.push_back(MakeRows("load0", r.load0->rate_hz, r.load0->f_tip_N,
                           [](const auto& f) { return Numbers(f); }));
    all.back().may_rest = true;
  }
  if (r.vision0) {
    all.push_back(MakeRows("vision0", r.vision0->rate_hz, r.vision0->tips, [](const auto& tip) {
      return tip.status == TipStatus::kLost ? std::vector<double>{} : Numbers(tip.p_RE);
    }));
  }
  if (r.cam0) {
    const auto none = [](const auto&) { return std::vector<double>{}; };
    const double rate = r.cam0->calibration.rate_hz;
    all.push_back(r.cam0->filenames.empty() ? MakeRows("cam0", rate, r.cam0->frame_numbers, none)
                                            : MakeRows("cam0", rate, r.cam0->filenames, none));
  }
  std::erase_if(all, [](const Rows& rows) { return rows.t_ns.empty(); });
  return all;
}

StreamFacts FactsOf(const Rows& rows, const Rows* wrist) {
  StreamFacts facts;
  facts.name = rows.name;
  facts.samples = rows.t_ns.size();
  facts.stated_rate_hz = rows.stated_rate_hz;
  if (rows.t_ns.empty()) return facts;
  facts.first_ns = rows.t_ns.front();
  facts.last_ns = rows.t_ns.back();
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i)
    facts.largest_gap_s = std::max(facts.largest_gap_s, Seconds(rows.t_ns[i - 1], rows.t_ns[i]));
  const double step = MedianStep_s(rows);
  if (step > 0.0) facts.median_rate_hz = 1.0 / step;
  if (wrist != nullptr && !wrist->t_ns.empty()) {
    const auto inside = std::count_if(rows.t_ns.begin(), rows.t_ns.end(), [&](TimeNs t) {
      return t >= wrist->t_ns.front() && t <= wrist->t_ns.back();
    });
    facts.overlap_with_wrist = static_cast<double>(inside) / static_cast<double>(rows.t_ns.size());
  }
  return facts;
}

std::vector<Finding> CheckTimes(const Recording& recording, const std::vector<Rows>& given,
                                Recording& repaired, Shifts& shifts) {
  std::vector<Finding> findings;
  repaired = recording;
  std::vector<double> durations;
  for (const Rows& r : given)
    if (r.t_ns.size() > 2) durations.push_back(Seconds(r.t_ns.front(), r.t_ns.back()));
  std::vector<std::string> in_other_unit;
  for (const Rows& r : given) {
    const auto unit = OtherTimeUnit(r, Median(durations));
    if (!unit) continue;
    in_other_unit.push_back(r.name);
    findings.push_back(
        {Severity::kWrong, r.name + ".time_unit",
         fmt::format("{}: time stamps look like {}: as nanoseconds its {} samples last {}, and "
                     "follow each other at {:.3g} Hz in place of {:.3g}",
                     r.name, unit->name, r.t_ns.size(),
                     Duration(Seconds(r.t_ns.front(), r.t_ns.back())), 1.0 / MedianStep_s(r),
                     r.stated_rate_hz),
         unit->factor > 1.0 ? fmt::format("multiply its time stamps by {:.0e}", unit->factor)
                            : fmt::format("divide its time stamps by {:.0e}", 1.0 / unit->factor)});
    ScaleTimes(repaired, r.name, unit->factor);
  }
  const std::vector<Rows> rows = in_other_unit.empty() ? given : RowsOf(repaired);
  for (const Rows& r : rows) {
    KeepRows(repaired, r.name, CheckStuck(r, rows, findings));
    const bool other_unit = std::count(in_other_unit.begin(), in_other_unit.end(), r.name) > 0;
    if (!other_unit) CheckRate(r, findings);
    CheckGap(r, rows, findings);
  }
  // Clocks that do not meet: is it the wrist's, or the others' own?
  const Rows* wrist = Find(rows, "wrist0");
  if (wrist == nullptr) return findings;
  std::vector<std::pair<std::string, double>> apart;
  std::size_t others = 0;
  for (const Rows& r : rows) {
    if (r.name == "wrist0") continue;
    ++others;
    if (Overlap(r, *wrist, 0.0) > 0.5) continue;
    apart.emplace_back(r.name, Seconds(wrist->t_ns.front(), r.t_ns.front()));
  }
  const bool all = apart.size() == others && others > 1 &&
                   std::all_of(apart.begin(), apart.end(), [&](const auto& a) {
                     return std::abs(a.second - apart.front().second) <
                            1.0 + 0.01 * std::abs(apart.front().second);
                   });
  const auto how = [](const std::string& name, double s) {
    return fmt::format("{} and wrist0 begin {} apart and do not meet", name, Duration(std::abs(s)));
  };
  if (all) {
    const double late = -apart.front().second;
    findings.push_back(ClockFinding("wrist0", late, how(apart.front().first, late)));
    shifts["wrist0"] = -late;
    return findings;
  }
  for (const auto& [name, late] : apart) {
    double refined = late;
    if (name == "em0" || name == "vision0" || name == "command0") {
      const auto lag = LagBySpeed(repaired, name, late);
      if (lag && lag->correlation > 0.8) refined = lag->seconds;
    }
    findings.push_back(ClockFinding(name, refined, how(name, late)));
    shifts[name] = -refined;
  }
  return findings;
}

std::vector<Finding> CheckLags(const Recording& r, Shifts& shifts) {
  std::vector<Finding> findings;
  if (!MotionIsResolved(r)) return findings;
  constexpr double kLeast_s = 0.25;  // latencies of sensors stay below
  std::vector<std::pair<std::string, Lag>> late;
  std::size_t compared = 0;
  for (const std::string stream : {"em0", "vision0", "command0"}) {
    if (shifts.contains(stream) || shifts.contains("wrist0")) continue;
    const auto lag = LagBySpeed(r, stream, 0.0);
    if (!lag) continue;
    ++compared;
    if (std::abs(lag->seconds) < kLeast_s || lag->correlation < 0.85) continue;
    if (1.0 - lag->correlation > 0.4 * (1.0 - lag->correlation_at_zero)) continue;
    late.emplace_back(stream, *lag);
  }
  const auto how = [](const Lag& lag) {
    return fmt::format("the speeds agree to {:.0f} % with this offset, to {:.0f} % without",
                       100.0 * lag.correlation, 100.0 * std::max(0.0, lag.correlation_at_zero));
  };
  const bool wrist = late.size() > 1 && late.size() == compared &&
                     std::all_of(late.begin(), late.end(), [&](const auto& l) {
                       return std::abs(l.second.seconds - late.front().second.seconds) < 0.2;
                     });
  if (wrist) {
    const double ahead = -late.front().second.seconds;
    findings.push_back(ClockFinding("wrist0", ahead, how(late.front().second)));
    shifts["wrist0"] = -ahead;
    return findings;
  }
  for (const auto& [name, lag] : late) {
    findings.push_back(ClockFinding(name, lag.seconds, how(lag)));
    shifts[name] = -lag.seconds;
  }
  // Forces against bending and against one another.
  const auto times = WristTimes(r, 200);
  const Scene frame = TakeScene(r, shifts, 0);
  const auto vector = [](const auto& v) -> std::optional<Eigen::VectorXd> {
    if (!v) return {};
    return Eigen::VectorXd(*v);
  };
  const auto now_with = [&](TimeNs t) { return InstantAt(r, t, shifts); };
  const auto lag_of = [&](const VectorAt& a, const VectorAt& b) -> std::optional<Lag> {
    const auto lag = FindLag(times, a, b, 0.0, 6.0, 0.1);
    if (!lag || std::abs(lag->seconds) < kLeast_s || lag->correlation < 0.85) return {};
    if (1.0 - lag->correlation > 0.4 * (1.0 - lag->correlation_at_zero)) return {};
    return lag;
  };
  const auto bending = [&](TimeNs t) -> std::optional<Eigen::VectorXd> {
    const Instant now = now_with(t);
    return now.wrist ? vector(TurnSeen(frame, now)) : std::nullopt;
  };
  const auto by_moments = [&](TimeNs t) -> std::optional<Eigen::VectorXd> {
    const Instant now = now_with(t);
    return now.wrist ? vector(TurnByMoments(frame, now)) : std::nullopt;
  };
  if (r.strain0 && !shifts.contains("strain0") && !shifts.contains("wrist0")) {
    if (const auto lag = lag_of(bending, by_moments)) {
      findings.push_back(ClockFinding(
          "strain0", lag->seconds,
          fmt::format("moments and bending agree to {:.0f} % with this offset, to {:.0f} % without",
                      100.0 * lag->correlation, 100.0 * std::max(0.0, lag->correlation_at_zero))));
      shifts["strain0"] = -lag->seconds;
    }
  }
  if (r.load0 && !shifts.contains("load0") && !shifts.contains("wrist0")) {
    const auto strain = [&](TimeNs t) -> std::optional<Eigen::VectorXd> {
      const Instant now = now_with(t);
      const auto end = TurnSeen(frame, now);
      if (!now.wrist || !now.strain_Nm || !end) return {};
      return Eigen::VectorXd(now.strain_Nm->tail<2>());
    };
    const auto load_moment = [&](TimeNs t) -> std::optional<Eigen::VectorXd> {
      const Instant now = now_with(t);
      return now.wrist ? vector(MomentByLoad(frame, now)) : std::nullopt;
    };
    const auto seen = [&](TimeNs t) -> std::optional<Eigen::VectorXd> {
      const Instant now = now_with(t);
      return now.wrist ? vector(DeflectionSeen(frame, now)) : std::nullopt;
    };
    const auto by_load = [&](TimeNs t) -> std::optional<Eigen::VectorXd> {
      const Instant now = now_with(t);
      return now.wrist ? vector(DeflectionByLoad(frame, now)) : std::nullopt;
    };
    auto lag = r.strain0 ? lag_of(strain, load_moment) : std::nullopt;
    if (!lag && !r.strain0) lag = lag_of(seen, by_load);
    if (lag) {
      findings.push_back(ClockFinding(
          "load0", lag->seconds,
          fmt::format("load and bending agree to {:.0f} % with this offset, to {:.0f} % without",
                      100.0 * lag->correlation, 100.0 * std::max(0.0, lag->correlation_at_zero))));
      shifts["load0"] = -lag->seconds;
    }
  }
  return findings;
}

}  // namespace flextip::plausibility
