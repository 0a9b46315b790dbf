#include "diagnosis/retiming.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

constexpr double kSameTime_s = 1e-6;
constexpr std::ptrdiff_t kNeighbours = 7;
constexpr double kLongestSpan = 16.0;  // of the neighbours, in periods of the samples

}  // namespace

template <class Get>
Retiming::Stream Retiming::MakeStream(int first_row, Get dt_s) const {
  Stream stream;
  for (std::size_t k = 0; k < samples_.samples.size(); ++k) {
    if (!samples_.samples[k].Has(first_row)) continue;
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

/// The nearest value, moved by the slope and bend of a parabola through its neighbours: each
/// measured value is used as it is, once, so its noise stays what it was and its own.
template <class Value>
void Retiming::Read(const Stream& stream, double dt_s, double delay_s,
                    Value DiagnosisSample::*value, DiagnosisSample& at) const {
  if (std::abs(dt_s - delay_s) < kSameTime_s) return;  // its own value is of that very time
  const auto n = std::ptrdiff_t(stream.t_s.size());
  const double wanted_s = at.t_s + delay_s;
  if (n < kNeighbours || !samples_.resolved_in_time) return;
  const auto after = std::lower_bound(stream.t_s.begin(), stream.t_s.end(), wanted_s);
  auto nearest = std::min<std::ptrdiff_t>(after - stream.t_s.begin(), n - 1);
  if (nearest > 0 && wanted_s - stream.t_s[nearest - 1] < stream.t_s[nearest] - wanted_s) --nearest;
  const auto first = std::clamp<std::ptrdiff_t>(nearest - kNeighbours / 2, 0, n - kNeighbours);
  const double span_s = stream.t_s[first + kNeighbours - 1] - stream.t_s[first];
  const double by_s = wanted_s - stream.t_s[nearest];
  if (span_s > kLongestSpan * samples_.period_s || std::abs(by_s) > span_s / (kNeighbours - 1))
    return;
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, Value::RowsAtCompileTime> rhs;
  rhs.setZero();
  for (std::ptrdiff_t a = first; a < first + kNeighbours; ++a) {
    const double u = (stream.t_s[a] - stream.t_s[nearest]) / span_s;
    const Eigen::Vector3d basis(1.0, u, u * u);
    N += basis * basis.transpose();
    rhs += basis * (samples_.samples[stream.k[a]].*value).transpose();
  }
  const Eigen::Matrix<double, 3, Value::RowsAtCompileTime> fit = N.inverse() * rhs;
  const double u = by_s / span_s;
  at.*value = samples_.samples[stream.k[nearest]].*value +
              (u * fit.row(1) + u * u * fit.row(2)).transpose();
}

DiagnosisSample Retiming::At(std::size_t k, double em_delay_s, double camera_delay_s) const {
  DiagnosisSample at = samples_.samples[k];
  if (at.Has(row::kEmPosition) || at.Has(row::kEmDirection)) {
    Read(em_, at.dt_em_s, em_delay_s, &DiagnosisSample::p_RS, at);
    Read(em_, at.dt_em_s, em_delay_s, &DiagnosisSample::d_em, at);
    at.d_em.normalize();
  }
  if (at.Has(row::kTipPosition))
    Read(tip_, at.dt_tip_s, camera_delay_s, &DiagnosisSample::p_RE, at);
  if (at.Has(row::kTipDirection)) {
    Read(tip_direction_, at.dt_tip_s, camera_delay_s, &DiagnosisSample::d_tip, at);
    at.d_tip.normalize();
  }
  if (at.Has(row::kPortDirection)) {
    Read(port_, at.dt_port_s, 0.0, &DiagnosisSample::d_port, at);
    at.d_port.normalize();
  }
  if (strain_.k.size() > 0) Read(strain_, at.dt_strain_s, 0.0, &DiagnosisSample::moments_Nm, at);
  return at;
}

}  // namespace flextip
