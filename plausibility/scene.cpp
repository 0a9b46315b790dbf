#include "plausibility/scene.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"

namespace flextip::plausibility {
namespace {

TimeNs Shifted(TimeNs t_ns, const Shifts& shifts_s, const char* stream) {
  const auto shift = shifts_s.find(stream);
  if (shift == shifts_s.end()) return t_ns;
  return t_ns - static_cast<TimeNs>(std::llround(shift->second * 1e9));
}

/// As FindBracket, and empty within a gap: a straight line over it is no motion.
template <class T>
std::optional<Bracket> BracketAt(const Series<T>& series, TimeNs t_ns) {
  constexpr double kGap_ns = 4e8, kSteps = 5.0;
  const auto where = FindBracket(series, t_ns);
  if (!where || where->fraction == 0.0) return where;
  const double mean_ns = static_cast<double>(series.back().t_ns - series.front().t_ns) /
                         static_cast<double>(series.size() - 1);
  const auto span_ns = static_cast<double>(series[where->i + 1].t_ns - series[where->i].t_ns);
  if (span_ns > std::max(kGap_ns, kSteps * mean_ns)) return {};
  return where;
}

std::optional<Placed> PlacedAt(const Series<WristSample>& samples, TimeNs t_ns) {
  const auto where = BracketAt(samples, t_ns);
  if (!where) return {};
  const WristSample& a = samples[where->i].value;
  if (where->fraction == 0.0) return Placed{a.p_RW, a.q_RW};
  const WristSample& b = samples[where->i + 1].value;
  Placed placed{Interpolate(a.p_RW, b.p_RW, where->fraction), {}};
  if (a.q_RW && b.q_RW) placed.q = Interpolate(*a.q_RW, *b.q_RW, where->fraction);
  return placed;
}

std::optional<Placed> PlacedAt(const Series<EmSample>& samples, TimeNs t_ns) {
  const auto where = BracketAt(samples, t_ns);
  if (!where) return {};
  const EmSample& a = samples[where->i].value;
  if (where->fraction == 0.0) return Placed{a.p_RS, a.q_RS};
  const EmSample& b = samples[where->i + 1].value;
  return Placed{Interpolate(a.p_RS, b.p_RS, where->fraction),
                Interpolate(a.q_RS, b.q_RS, where->fraction)};
}

/// A camera knows depth worst: the covariance's longest axis, where it is twice the others.
std::optional<Eigen::Vector3d> SightOf(const Eigen::Matrix3d& covariance) {
  const SymmetricEigen axes(covariance);
  const Eigen::Vector3d& variances = axes.values;
  if (!(variances[2] > 4.0 * std::max(variances[1], 0.0)) || !(variances[2] > 0.0)) return {};
  return Eigen::Vector3d(axes.vectors.col(2));
}

std::optional<Seen> SeenAt(const Series<TipObservation>& tips, TimeNs t_ns) {
  const auto where = BracketAt(tips, t_ns);
  if (!where) return {};
  const TipObservation& a = tips[where->i].value;
  if (a.status == TipStatus::kLost) return {};
  if (where->fraction == 0.0) return Seen{a.p_RE, a.d_RE, SightOf(a.covariance_m2)};
  const TipObservation& b = tips[where->i + 1].value;
  if (b.status == TipStatus::kLost) return {};
  Seen seen{Interpolate(a.p_RE, b.p_RE, where->fraction), {}, SightOf(a.covariance_m2)};
  if (a.d_RE && b.d_RE) seen.d = Interpolate(*a.d_RE, *b.d_RE, where->fraction).normalized();
  return seen;
}

template <class T>
std::optional<T> NumbersAt(const Series<T>& series, TimeNs t_ns) {
  const auto where = BracketAt(series, t_ns);
  if (!where) return {};
  const T& a = series[where->i].value;
  if (where->fraction == 0.0) return a;
  return T(a + where->fraction * (series[where->i + 1].value - a));
}

double WristStepOf(const Recording& r) {
  double squares = 0.0;
  std::size_t count = 0;
  const auto& commands = r.command0->p_RW;
  for (std::size_t i = 1; i < commands.size(); ++i) {
    const auto from = PlacedAt(r.wrist0->samples, commands[i - 1].t_ns);
    const auto to = PlacedAt(r.wrist0->samples, commands[i].t_ns);
    if (from && to) squares += (to->p - from->p).squaredNorm(), ++count;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

}  // namespace

bool Scene::Has(const std::string& stream) const {
  return std::find(streams.begin(), streams.end(), stream) != streams.end();
}

std::optional<Eigen::Vector3d> PlaceAt(const Recording& r, const std::string& stream, TimeNs t_ns) {
  if (stream == "command0" && r.command0) return NumbersAt(r.command0->p_RW, t_ns);
  std::optional<Placed> placed;
  if (stream == "wrist0" && r.wrist0) placed = PlacedAt(r.wrist0->samples, t_ns);
  if (stream == "em0" && r.em0) placed = PlacedAt(r.em0->samples, t_ns);
  if (stream == "em1" && r.em1) placed = PlacedAt(r.em1->samples, t_ns);
  if (placed) return placed->p;
  if (stream != "vision0" || !r.vision0) return {};
  const auto where = BracketAt(r.vision0->tips, t_ns);
  if (!where) return {};
  const TipObservation& a = r.vision0->tips[where->i].value;
  if (a.status == TipStatus::kLost) return {};
  if (where->fraction == 0.0) return a.p_RE;
  const TipObservation& b = r.vision0->tips[where->i + 1].value;
  if (b.status == TipStatus::kLost) return {};
  return Interpolate(a.p_RE, b.p_RE, where->fraction);
}

Instant InstantAt(const Recording& r, TimeNs t_ns, const Shifts& shifts_s) {
  const auto at = [&](const char* stream) { return Shifted(t_ns, shifts_s, stream); };
  Instant now;
  now.t_ns = t_ns;
  if (r.wrist0) now.wrist = PlacedAt(r.wrist0->samples, t_ns);
  if (r.em0) now.em0 = PlacedAt(r.em0->samples, at("em0"));
  if (r.em1) now.em1 = PlacedAt(r.em1->samples, at("em1"));
  if (r.vision0) now.tip = SeenAt(r.vision0->tips, at("vision0"));
  if (r.strain0) now.strain_Nm = NumbersAt(r.strain0->moments_Nm, at("strain0"));
  if (r.load0) now.load_N = NumbersAt(r.load0->f_tip_N, at("load0"));
  if (r.command0) now.command = NumbersAt(r.command0->p_RW, at("command0"));
  return now;
}

Scene TakeScene(const Recording& r, const Shifts& shifts_s, int count) {
  Scene scene;
  scene.instrument = r.instrument;
  scene.p_RP = r.p_RP;
  scene.gravity_m_s2 = r.gravity_m_s2;
  const double reach = r.instrument.length_m;
  if (r.wrist0) scene.streams.emplace_back("wrist0");
  if (r.command0) scene.streams.emplace_back("command0");
  if (r.command0 && r.wrist0) scene.wrist_step_m = WristStepOf(r);
  if (r.em0) {
    scene.streams.emplace_back("em0");
    scene.em0_from_tip_m = r.em0->distance_from_tip_m;
    scene.em0_registration_m =
        r.em0->registration_noise_m + std::min(0.5, r.em0->registration_noise_rad) * reach;
  }
  if (r.em1) scene.streams.emplace_back("em1");
  if (r.strain0) {
    scene.streams.emplace_back("strain0");
    for (int i = 0; i < 2; ++i) scene.station_m[i] = r.strain0->station_from_wrist_m[i];
    scene.strain_noise_Nm = r.strain0->moment_noise_Nm;
  }
  if (r.load0) {
    scene.streams.emplace_back("load0");
    scene.load_noise_N = r.load0->force_noise_N;
  }
  if (r.vision0) {
    scene.streams.emplace_back("vision0");
    scene.tip_registration_m =
        r.vision0->registration_noise_m + std::min(0.5, r.vision0->registration_noise_rad) * reach;
  }
  if (r.cam0) {
    scene.streams.emplace_back("cam0");
    if (r.cam0->has_T_RC) scene.camera = r.cam0->calibration;
  }
  if (!r.wrist0 || r.wrist0->samples.empty() || count < 1) return scene;
  const auto& samples = r.wrist0->samples;
  const std::size_t picks = std::min(samples.size(), static_cast<std::size_t>(count));
  // The wrist's own clock may be the one that is off.
  const auto wrist_shift = shifts_s.find("wrist0");
  const TimeNs own_ns = wrist_shift == shifts_s.end()
                            ? 0
                            : static_cast<TimeNs>(std::llround(wrist_shift->second * 1e9));
  for (std::size_t k = 0; k < picks; ++k) {
    const std::size_t i = picks == 1 ? 0 : k * (samples.size() - 1) / (picks - 1);
    Instant now = InstantAt(r, samples[i].t_ns + own_ns, shifts_s);
    now.wrist = Placed{samples[i].value.p_RW, samples[i].value.q_RW};
    scene.instants.push_back(std::move(now));
  }
  return scene;
}

}  // namespace flextip::plausibility
