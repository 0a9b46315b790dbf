#include "plausibility/timing/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace flextip::plausibility {
namespace {

template <class T, class Values>
Rows MakeRows(const std::string& name, double rate_hz, const Series<T>& series, Values values_of) {
  Rows rows{name, rate_hz, {}, {}, false, 0.0};
  for (const Sample<T>& sample : series) {
    rows.t_ns.push_back(sample.t_ns);
    rows.values.push_back(values_of(sample.value));
  }
  return rows;
}

template <class Vector>
std::vector<double> NumbersOf(const Vector& v) {
  return {v.data(), v.data() + v.size()};
}

std::vector<double> NumbersOf(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

Rows EmRows(const std::string& name, const EmStream& stream) {
  Rows rows = MakeRows(name, stream.rate_hz, stream.samples,
                       [](const EmSample& s) { return NumbersOf(s.p_RS, s.q_RS); });
  rows.noise = stream.position_noise_m;
  return rows;
}

Rows CameraRows(const CameraStream& camera) {
  const auto none = [](const auto&) { return std::vector<double>{}; };
  const double rate = camera.calibration.rate_hz;
  return camera.filenames.empty() ? MakeRows("cam0", rate, camera.frame_numbers, none)
                                  : MakeRows("cam0", rate, camera.filenames, none);
}

}  // namespace

std::vector<Rows> RowsOf(const Recording& r) {
  std::vector<Rows> all;
  if (r.wrist0) {
    all.push_back(MakeRows("wrist0", r.wrist0->rate_hz, r.wrist0->samples, [](const auto& s) {
      return s.q_RW ? NumbersOf(s.p_RW, *s.q_RW) : NumbersOf(s.p_RW);
    }));
  }
  if (r.command0) {
    all.push_back(MakeRows("command0", r.command0->rate_hz, r.command0->p_RW,
                           [](const auto& p) { return NumbersOf(p); }));
    all.back().may_rest = true;
  }
  if (r.em0) all.push_back(EmRows("em0", *r.em0));
  if (r.em1) all.push_back(EmRows("em1", *r.em1));
  if (r.strain0) {
    all.push_back(MakeRows("strain0", r.strain0->rate_hz, r.strain0->moments_Nm,
                           [](const auto& m) { return NumbersOf(m); }));
    all.back().noise = r.strain0->moment_noise_Nm;
  }
  if (r.load0) {
    all.push_back(MakeRows("load0", r.load0->rate_hz, r.load0->f_tip_N,
                           [](const auto& f) { return NumbersOf(f); }));
    all.back().may_rest = true;
  }
  if (r.vision0) {
    all.push_back(MakeRows("vision0", r.vision0->rate_hz, r.vision0->tips, [](const auto& tip) {
      return tip.status == TipStatus::kLost ? std::vector<double>{} : NumbersOf(tip.p_RE);
    }));
  }
  if (r.cam0) all.push_back(CameraRows(*r.cam0));
  std::erase_if(all, [](const Rows& rows) { return rows.t_ns.empty(); });
  return all;
}

const Rows* FindRows(const std::vector<Rows>& rows, const std::string& name) {
  for (const Rows& r : rows)
    if (r.name == name) return &r;
  return nullptr;
}

StreamFacts FactsOf(const Rows& rows, const Rows* wrist) {
  StreamFacts facts;
  facts.name = rows.name;
  facts.samples = rows.t_ns.size();
  facts.stated_rate_hz = rows.stated_rate_hz;
  if (rows.t_ns.empty()) return facts;
  facts.first_ns = rows.t_ns.front();
  facts.last_ns = rows.t_ns.back();
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i) {
    facts.largest_gap_s =
        std::max(facts.largest_gap_s, SecondsBetween(rows.t_ns[i - 1], rows.t_ns[i]));
  }
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

double MedianStep_s(const Rows& rows) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i)
    steps.push_back(SecondsBetween(rows.t_ns[i - 1], rows.t_ns[i]));
  return Median(std::move(steps));
}

double SecondsBetween(TimeNs from_ns, TimeNs to_ns) {
  return 1e-9 * static_cast<double>(to_ns - from_ns);
}

std::string DurationText(double seconds) {
  constexpr double kHour_s = 3600.0, kDay_s = 86400.0, kYear_s = 365.25 * kDay_s;
  const double size = std::abs(seconds);
  if (size >= 2.0 * kYear_s) return fmt::format("{:.1f} years", seconds / kYear_s);
  if (size >= 2.0 * kDay_s) return fmt::format("{:.1f} days", seconds / kDay_s);
  if (size >= kHour_s) return fmt::format("{:.2f} h", seconds / kHour_s);
  if (size >= 1.0) return fmt::format("{:.2f} s", seconds);
  if (size >= 1e-3) return fmt::format("{:.0f} ms", 1e3 * seconds);
  return fmt::format("{:.3g} us", 1e6 * seconds);
}

}  // namespace flextip::plausibility
