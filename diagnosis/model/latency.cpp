#include "diagnosis/model/latency.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/rotation.h"
#include "diagnosis/effects/discovered/term_columns.h"
#include "diagnosis/model/extended_effect.h"

namespace flextip::diagnosis {
namespace {

/// A stamp's error by a term of the time.
double ValueOf(const Term& term, double t_s) {
  TermState state;
  state.t_s = state.scalar[static_cast<std::size_t>(TermVariable::kTime)] = t_s;
  EffectMemory none{};
  double value = term.offset.size() > 0 ? term.offset[0] : 0.0;
  if (term.Columns() == 0) return value;
  return value + term.amplitude.row(0).dot(ColumnsAt(term, state, none).row(0));
}

struct Delay {
  double value_s = 0.0, sd_s = 0.0;
  double growth = 0.0, growth_sd = 0.0;  ///< in each second since the recording's start
  TimeNs start_ns = 0;
  std::vector<Term> terms = {};  ///< of the time alone

  double SinceStart_s(TimeNs t_ns) const { return 1e-9 * static_cast<double>(t_ns - start_ns); }
  double At(TimeNs t_ns) const {
    double delay_s = value_s + growth * SinceStart_s(t_ns);
    for (const Term& term : terms) delay_s += ValueOf(term, SinceStart_s(t_ns));
    return delay_s;
  }
  double SdAt(TimeNs t_ns) const { return std::hypot(sd_s, growth_sd * SinceStart_s(t_ns)); }
};

/// The delay of a sensor's stamps by all of `effects` that act on it.
Delay DelayBy(const std::vector<EffectFit>& effects, int delay_input, TimeNs start_ns,
              const EffectMakers& own) {
  Delay delay;
  delay.start_ns = start_ns;
  for (const EffectFit& fit : effects) {
    const auto effect = MakeEffectOfModel(fit.effect, own);
    if (!effect || effect->DelayInput() != delay_input) continue;
    const ReportedParameter& parameter = fit.parameters.at(0);
    const double sd = parameter.sd.empty() ? 0.0 : parameter.sd[0];
    if (effect->DelayGrows()) {
      delay.growth -= parameter.value.at(0);
      delay.growth_sd = std::hypot(delay.growth_sd, sd);
    } else {
      delay.value_s += parameter.value.at(0);
      delay.sd_s = std::hypot(delay.sd_s, sd);
    }
  }
  return delay;
}

/// Where an error jumps, samples keep their order: one that would come before the last comes
/// right after it.
template <class Samples>
void MoveStamps(Samples& samples, const Delay& delay) {
  TimeNs next_ns = std::numeric_limits<TimeNs>::min();
  for (auto& sample : samples) {
    sample.t_ns -= static_cast<TimeNs>(std::llround(1e9 * delay.At(sample.t_ns)));
    sample.t_ns = std::max(next_ns, sample.t_ns);
    next_ns = sample.t_ns + 1;
  }
}

/// Two neighbours of a sample and the seconds between them; the same at the series' ends.
struct Around {
  std::size_t before, after;
  double span_s;
};

template <class Value>
Around NeighboursOf(const Series<Value>& samples, std::size_t i) {
  Around around{i > 0 ? i - 1 : i, std::min(i + 1, samples.size() - 1), 0.0};
  around.span_s =
      1e-9 * static_cast<double>(samples[around.after].t_ns - samples[around.before].t_ns);
  return around;
}

void MoveAlongPath(EmStream& em, const Delay& delay) {
  const Series<EmSample> measured = em.samples;
  double off2_m2 = 0.0, turn2_rad2 = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto [before, after, span_s] = NeighboursOf(measured, i);
    if (span_s <= 0.0) continue;
    const EmSample &a = measured[before].value, &b = measured[after].value;
    const Eigen::Vector3d speed = (b.p_RS - a.p_RS) / span_s;
    const Eigen::Vector3d turning =
        LogRotation((b.q_RS * a.q_RS.conjugate()).toRotationMatrix()) / span_s;
    const double delay_s = delay.At(measured[i].t_ns), sd_s = delay.SdAt(measured[i].t_ns);
    em.samples[i].value.p_RS += delay_s * speed;
    em.samples[i].value.q_RS =
        Eigen::Quaterniond(ExpRotation(delay_s * turning)) * measured[i].value.q_RS;
    off2_m2 += sd_s * sd_s * speed.squaredNorm() / static_cast<double>(measured.size());
    turn2_rad2 += sd_s * sd_s * turning.squaredNorm() / static_cast<double>(measured.size());
  }
  // A stream has one noise: that of the mean speed, shared by the axes.
  em.position_noise_m = std::hypot(em.position_noise_m, std::sqrt(off2_m2 / 3.0));
  em.orientation_noise_rad = std::hypot(em.orientation_noise_rad, std::sqrt(turn2_rad2 / 3.0));
}

void MoveAlongPath(VisionStream& vision, const Delay& delay) {
  const Series<TipObservation> measured = vision.tips;
  const auto seen = [&](std::size_t i) { return measured[i].value.status != TipStatus::kLost; };
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto [before, after, span_s] = NeighboursOf(measured, i);
    if (!seen(before) || !seen(i) || !seen(after) || span_s <= 0.0) continue;
    const TipObservation &a = measured[before].value, &b = measured[after].value;
    TipObservation& tip = vision.tips[i].value;
    const Eigen::Vector3d speed = (b.p_RE - a.p_RE) / span_s;
    const double delay_s = delay.At(measured[i].t_ns), sd_s = delay.SdAt(measured[i].t_ns);
    tip.p_RE += delay_s * speed;
    tip.covariance_m2 += sd_s * sd_s * speed * speed.transpose();
    if (tip.d_RE && a.d_RE && b.d_RE)
      tip.d_RE = (*tip.d_RE + delay_s / span_s * (*b.d_RE - *a.d_RE)).normalized();
  }
}

}  // namespace

Recording WithoutLatency(Recording recording, const ExtendedModel& model, const EffectMakers& own) {
  const auto by = [&](const std::vector<EffectFit>& effects, int delay_input) {
    return DelayBy(effects, delay_input, model.start_ns, own);
  };
  Delay em = by(model.effects, sample_input::kEmDelay);
  Delay camera = by(model.effects, sample_input::kCameraDelay);
  for (const Term& term : model.discovered) {
    if (term.target == TermTarget::kEmTime) em.terms.push_back(term);
    if (term.target == TermTarget::kVisionTime) camera.terms.push_back(term);
  }
  const Delay em_within = by(model.within_tolerance, sample_input::kEmDelay);
  const Delay camera_within = by(model.within_tolerance, sample_input::kCameraDelay);
  for (auto* stream : {&recording.em0, &recording.em1}) {
    if (!*stream) continue;
    MoveStamps((*stream)->samples, em);
    MoveAlongPath(**stream, em_within);
  }
  if (recording.vision0) {
    MoveStamps(recording.vision0->tips, camera);
    MoveAlongPath(*recording.vision0, camera_within);
  }
  return recording;
}

}  // namespace flextip::diagnosis
