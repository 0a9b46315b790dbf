#include "diagnosis/model/latency.h"

#include <algorithm>
#include <cmath>

#include "core/rotation.h"
#include "diagnosis/model/extended_effect.h"

namespace flextip::diagnosis {
namespace {

struct Delay {
  double value_s = 0.0, sd_s = 0.0;
};

/// The delay of a sensor's stamps by all of `effects` that act on it.
Delay DelayBy(const std::vector<EffectFit>& effects, int delay_input, const EffectMakers& own) {
  Delay delay;
  for (const EffectFit& fit : effects) {
    const auto effect = MakeEffectOfModel(fit.effect, own);
    if (!effect || effect->DelayInput() != delay_input) continue;
    const ReportedParameter& parameter = fit.parameters.at(0);
    delay.value_s += parameter.value.at(0);
    if (!parameter.sd.empty()) delay.sd_s = std::hypot(delay.sd_s, parameter.sd[0]);
  }
  return delay;
}

template <class Samples>
void MoveStamps(Samples& samples, double delay_s) {
  const auto delay_ns = static_cast<TimeNs>(std::llround(1e9 * delay_s));
  for (auto& sample : samples) sample.t_ns -= delay_ns;
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
  double speed2 = 0.0, turning2 = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const auto [before, after, span_s] = NeighboursOf(measured, i);
    if (span_s <= 0.0) continue;
    const EmSample &a = measured[before].value, &b = measured[after].value;
    const Eigen::Vector3d speed = (b.p_RS - a.p_RS) / span_s;
    const Eigen::Vector3d turning =
        LogRotation((b.q_RS * a.q_RS.conjugate()).toRotationMatrix()) / span_s;
    em.samples[i].value.p_RS += delay.value_s * speed;
    em.samples[i].value.q_RS =
        Eigen::Quaterniond(ExpRotation(delay.value_s * turning)) * measured[i].value.q_RS;
    speed2 += speed.squaredNorm() / static_cast<double>(measured.size());
    turning2 += turning.squaredNorm() / static_cast<double>(measured.size());
  }
  // A stream has one noise: that of the mean speed, shared by the axes.
  em.position_noise_m = std::hypot(em.position_noise_m, delay.sd_s * std::sqrt(speed2 / 3.0));
  em.orientation_noise_rad =
      std::hypot(em.orientation_noise_rad, delay.sd_s * std::sqrt(turning2 / 3.0));
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
    tip.p_RE += delay.value_s * speed;
    tip.covariance_m2 += delay.sd_s * delay.sd_s * speed * speed.transpose();
    if (tip.d_RE && a.d_RE && b.d_RE)
      tip.d_RE = (*tip.d_RE + delay.value_s / span_s * (*b.d_RE - *a.d_RE)).normalized();
  }
}

}  // namespace

Recording WithoutLatency(Recording recording, const ExtendedModel& model, const EffectMakers& own) {
  const Delay em = DelayBy(model.effects, sample_input::kEmDelay, own);
  const Delay camera = DelayBy(model.effects, sample_input::kCameraDelay, own);
  const Delay em_within = DelayBy(model.within_tolerance, sample_input::kEmDelay, own);
  const Delay camera_within = DelayBy(model.within_tolerance, sample_input::kCameraDelay, own);
  for (auto* stream : {&recording.em0, &recording.em1}) {
    if (!*stream) continue;
    MoveStamps((*stream)->samples, em.value_s);
    MoveAlongPath(**stream, em_within);
  }
  if (recording.vision0) {
    MoveStamps(recording.vision0->tips, camera.value_s);
    MoveAlongPath(*recording.vision0, camera_within);
  }
  return recording;
}

}  // namespace flextip::diagnosis
