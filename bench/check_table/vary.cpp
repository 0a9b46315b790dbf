#include "bench/check_table/vary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/draw_vector.h"
#include "core/pose.h"
#include "core/rotation.h"

namespace flextip::bench {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Rng = std::mt19937_64;

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}
bool Chance(Rng& rng, double probability) { return Uniform(rng, 0.0, 1.0) < probability; }
TimeNs Ns(double seconds) { return static_cast<TimeNs>(std::llround(seconds * 1e9)); }

/// Calls `change` with every series of numbers and its stated rate.
template <class Change>
void EachSeries(Recording& r, const Change& change) {
  if (r.wrist0) change(r.wrist0->samples, r.wrist0->rate_hz, false);
  if (r.command0) change(r.command0->p_RW, r.command0->rate_hz, false);
  if (r.em0) change(r.em0->samples, r.em0->rate_hz, true);
  if (r.em1) change(r.em1->samples, r.em1->rate_hz, true);
  if (r.strain0) change(r.strain0->moments_Nm, r.strain0->rate_hz, true);
  if (r.load0) change(r.load0->f_tip_N, r.load0->rate_hz, true);
  if (r.vision0) change(r.vision0->tips, r.vision0->rate_hz, true);
}

/// Puts the origin of R elsewhere and turns its axes.
void ChangeFrame(Recording& r, const Pose& T) {
  const Quaterniond q = T.Quaternion();
  if (r.wrist0) {
    for (auto& s : r.wrist0->samples) {
      s.value.p_RW = T * s.value.p_RW;
      if (s.value.q_RW) s.value.q_RW = q * *s.value.q_RW;
    }
  }
  if (r.command0)
    for (auto& s : r.command0->p_RW) s.value = T * s.value;
  for (auto* em : {&r.em0, &r.em1}) {
    if (!*em) continue;
    for (auto& s : (*em)->samples) s.value = {T * s.value.p_RS, q * s.value.q_RS};
  }
  if (r.load0)
    for (auto& s : r.load0->f_tip_N) s.value = T.R * s.value;
  if (r.vision0) {
    for (auto& s : r.vision0->tips) {
      s.value.p_RE = T * s.value.p_RE;
      s.value.covariance_m2 = T.R * s.value.covariance_m2 * T.R.transpose();
      if (s.value.d_RE) s.value.d_RE = T.R * *s.value.d_RE;
    }
  }
  for (auto* camera : {&r.cam0, &r.cam1})
    if (*camera) (*camera)->calibration.T_RC = T * (*camera)->calibration.T_RC;
  r.p_RP = T * r.p_RP;
  r.gravity_m_s2 = T.R * r.gravity_m_s2;
}

template <class T>
void TakeEvery(Series<T>& series, std::size_t nth) {
  std::size_t i = 0;
  std::erase_if(series, [&](const Sample<T>&) { return i++ % nth != 0; });
}

/// Stamps late by the same time, jitter of a twentieth of a step, and a hundredth dropped.
template <class T>
void Restamp(Series<T>& series, double rate_hz, double late_s, Rng& rng) {
  const double step_s = rate_hz > 0.0 ? 1.0 / rate_hz : 0.02;
  for (auto& s : series) s.t_ns += Ns(late_s + step_s * Uniform(rng, -0.05, 0.05));
  std::size_t i = 0;
  std::erase_if(series, [&](const Sample<T>&) { return ++i > 2 && Chance(rng, 0.01); });
}

/// Begins and ends at its own time, up to a tenth of the series later or earlier.
template <class T>
void CutEnds(Series<T>& series, Rng& rng) {
  const double n = static_cast<double>(series.size());
  const auto head = static_cast<std::ptrdiff_t>(n * Uniform(rng, 0.0, 0.1));
  const auto tail = static_cast<std::ptrdiff_t>(n * Uniform(rng, 0.0, 0.1));
  series.erase(series.end() - tail, series.end());
  series.erase(series.begin(), series.begin() + head);
}

void LoseTips(VisionStream& vision, Rng& rng) {
  for (std::size_t i = 0; i < vision.tips.size(); ++i) {
    if (!Chance(rng, 0.01)) continue;
    const auto frames = static_cast<std::size_t>(Uniform(rng, 1.0, 12.0));
    for (std::size_t k = i; k < std::min(i + frames, vision.tips.size()); ++k)
      vision.tips[k].value = {};  // lost
  }
}

void Round(Vector3d& p, double to) {
  for (double& x : p) x = to * std::round(x / to);
}

/// As a program prints them: 0.01 mm, five digits of a quaternion.
void RoundNumbers(Recording& r) {
  constexpr double kPlace_m = 1e-5, kTurn = 1e-5;
  const auto round = [](Quaterniond& q) {
    for (double& x : q.coeffs()) x = kTurn * std::round(x / kTurn);
    q.normalize();
  };
  if (r.wrist0) {
    for (auto& s : r.wrist0->samples) {
      Round(s.value.p_RW, kPlace_m);
      if (s.value.q_RW) round(*s.value.q_RW);
    }
  }
  if (r.em0) {
    for (auto& s : r.em0->samples) {
      Round(s.value.p_RS, kPlace_m);
      round(s.value.q_RS);
    }
  }
}

/// w never negative: neighbours then differ in sign where w goes through zero.
void MakePositive(Recording& r) {
  const auto flip = [](Quaterniond& q) {
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  };
  if (r.wrist0) {
    for (auto& s : r.wrist0->samples)
      if (s.value.q_RW) flip(*s.value.q_RW);
  }
  if (r.em0)
    for (auto& s : r.em0->samples) flip(s.value.q_RS);
}

}  // namespace

std::string Vary(Recording& r, Rng& rng) {
  std::string words;
  if (Chance(rng, 0.7)) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const Vector3d turn = DrawVector<3>(uniform, rng), p = DrawVector<3>(uniform, rng);
    Pose T;
    T.R = ExpRotation(3.0 * turn);
    T.p = p;
    ChangeFrame(r, T);
    words += "other frame, ";
  }
  double late_s = 0.0;
  EachSeries(r, [&](auto& series, double& rate_hz, bool may_be_late) {
    const auto nth = static_cast<std::size_t>(Uniform(rng, 1.0, 3.99));
    if (rate_hz / static_cast<double>(nth) > 9.0) {
      TakeEvery(series, nth);
      rate_hz /= static_cast<double>(nth);
    }
    late_s = may_be_late ? Uniform(rng, 0.0, 0.06) : 0.0;
    Restamp(series, rate_hz, late_s, rng);
    CutEnds(series, rng);
  });
  if (r.vision0) LoseTips(*r.vision0, rng);
  const std::vector<double> origins{0.0, 12.3, 1e3, 1.4e9, 1.7e9};
  const double origin =
      origins[std::uniform_int_distribution<std::size_t>(0, origins.size() - 1)(rng)];
  if (r.wrist0) {
    TimeNs first = r.wrist0->samples.front().t_ns;
    EachSeries(r, [&](auto& series, double&, bool) { first = std::min(first, series[0].t_ns); });
    EachSeries(r, [&](auto& series, double&, bool) {
      for (auto& s : series) s.t_ns += Ns(origin) - first;
    });
  }
  words += fmt::format("times from {:g} s", origin);
  if (Chance(rng, 0.3)) RoundNumbers(r), words += ", rounded";
  if (Chance(rng, 0.5)) MakePositive(r);
  return words;
}

}  // namespace flextip::bench
