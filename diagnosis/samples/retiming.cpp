#include "diagnosis/samples/retiming.h"

#include <algorithm>
#include <cmath>

namespace flextip::diagnosis {
namespace {

constexpr double kLongestStep_s = 0.06;  // that the model's rates are trusted for

}  // namespace

template <class Get>
Retiming::Stream Retiming::MakeStream(int first_row, Get dt_s) const {
  Stream stream;
  for (std::size_t k = 0; k < samples_.samples.size(); ++k) {
    if (!samples_.samples[k].spoken[first_row]) continue;
    stream.k.push_back(k);
    stream.t_s.push_back(samples_.samples[k].t_s + dt_s(samples_.samples[k]));
  }
  return stream;
}

Retiming::Retiming(const SampleSet& samples)
    : samples_(samples),
      em_(MakeStream(samples.noise.em_position_m > 0.0 ? row::kEmPosition : row::kEmDirection,
                     [](const DiagnosisSample& s) { return s.dt_em_s; })),
      strain_(MakeStream(row::kStrain, [](const DiagnosisSample& s) { return s.dt_strain_s; })),
      tip_(MakeStream(row::kTipPosition, [](const DiagnosisSample& s) { return s.dt_tip_s; })),
      tip_direction_(
          MakeStream(row::kTipDirection, [](const DiagnosisSample& s) { return s.dt_tip_s; })),
      port_(MakeStream(row::kPortDirection, [](const DiagnosisSample& s) { return s.dt_port_s; })) {
}

/// The value measured nearest to `delay_s` after the sample, as it was measured, and how long after
/// the sample that was.
template <class Value>
void Retiming::Read(const Stream& stream, double delay_s, Value DiagnosisSample::*value,
                    double DiagnosisSample::*dt_s, DiagnosisSample& at) const {
  if (stream.t_s.empty() || !samples_.resolved_in_time) return;
  const double wanted_s = at.t_s + delay_s;
  const auto n = std::ptrdiff_t(stream.t_s.size());
  const auto after = std::lower_bound(stream.t_s.begin(), stream.t_s.end(), wanted_s);
  auto nearest = std::min<std::ptrdiff_t>(after - stream.t_s.begin(), n - 1);
  if (nearest > 0 && wanted_s - stream.t_s[nearest - 1] < stream.t_s[nearest] - wanted_s) --nearest;
  if (std::abs(stream.t_s[nearest] - wanted_s) > kLongestStep_s) {
    at.*dt_s = delay_s;  // beside a gap: its own value, as it stands
    return;
  }
  at.*value = samples_.samples[stream.k[nearest]].*value;
  at.*dt_s = stream.t_s[nearest] - at.t_s;
}

DiagnosisSample Retiming::At(std::size_t k, double em_delay_s, double camera_delay_s) const {
  DiagnosisSample at = samples_.samples[k];
  if (at.Has(row::kEmPosition) || at.Has(row::kEmDirection)) {
    Read(em_, em_delay_s, &DiagnosisSample::p_RS, &DiagnosisSample::dt_em_s, at);
    Read(em_, em_delay_s, &DiagnosisSample::d_em, &DiagnosisSample::dt_em_s, at);
  }
  if (at.Has(row::kTipPosition))
    Read(tip_, camera_delay_s, &DiagnosisSample::p_RE, &DiagnosisSample::dt_tip_s, at);
  if (at.Has(row::kTipDirection))
    Read(tip_direction_, camera_delay_s, &DiagnosisSample::d_tip, &DiagnosisSample::dt_tip_s, at);
  if (at.Has(row::kPortDirection))
    Read(port_, 0.0, &DiagnosisSample::d_port, &DiagnosisSample::dt_port_s, at);
  if (!strain_.k.empty())
    Read(strain_, 0.0, &DiagnosisSample::moments_Nm, &DiagnosisSample::dt_strain_s, at);
  return at;
}

}  // namespace flextip::diagnosis
