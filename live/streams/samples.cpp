#include "live/streams/samples.h"

#include <cmath>

#include "core/linear_algebra.h"

namespace flextip::live {
namespace {

constexpr double kUnitTolerance = 1e-3;
constexpr double kPerMillimetre = 1e-3;

bool IsRotation(const Eigen::Matrix3d& R) {
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return off <= kUnitTolerance && R.determinant() > 0;
}

std::optional<AnySample> WristIn(const WireTransform& body) {
  WristSample sample{body.T_RD.p, {}};
  if (body.has_orientation) {
    if (!IsRotation(body.T_RD.R)) return {};
    sample.q_RW = body.T_RD.Quaternion();
  }
  return sample;
}

std::optional<AnySample> EmIn(const WireTransform& body) {
  if (!body.has_orientation || !IsRotation(body.T_RD.R)) return {};
  return EmSample{body.T_RD.p, body.T_RD.Quaternion()};
}

/// p (mm), covariance row by row (mm^2), direction (unit; zeros: not seen), its noise (rad).
std::optional<AnySample> TipIn(const std::vector<double>& v) {
  if (v.size() != 16) return {};
  SeenTip seen;
  seen.tip.status = TipStatus::kOk;
  for (int i = 0; i < 3; ++i) seen.tip.p_RE[i] = kPerMillimetre * v[i];
  for (int i = 0; i < 9; ++i)
    seen.tip.covariance_m2(i / 3, i % 3) = kPerMillimetre * kPerMillimetre * v[3 + i];
  seen.tip.covariance_m2 =
      (0.5 * (seen.tip.covariance_m2 + seen.tip.covariance_m2.transpose())).eval();
  if (SymmetricEigenvalues(seen.tip.covariance_m2)(0) < 0.0) return {};
  const Eigen::Vector3d d(v[12], v[13], v[14]);
  if (d.norm() > 0.0) {
    if (std::abs(d.norm() - 1.0) > kUnitTolerance || v[15] < 0.0) return {};
    seen.tip.d_RE = d.normalized();
    seen.direction_noise_rad = v[15];
  }
  return seen;
}

bool IsFinite(const std::vector<double>& values) {
  for (const double value : values)
    if (!std::isfinite(value)) return false;
  return true;
}

std::optional<AnySample> NumbersIn(StreamName stream, const std::vector<double>& v) {
  if (!IsFinite(v)) return {};
  if (stream == StreamName::kTip) return TipIn(v);
  if (stream == StreamName::kStrain && v.size() == 4)
    return Eigen::Vector4d(v[0], v[1], v[2], v[3]);
  if (stream == StreamName::kLoad && v.size() == 3) return Eigen::Vector3d(v[0], v[1], v[2]);
  return {};
}

}  // namespace

std::optional<AnySample> SampleIn(StreamName stream, const WireMessage& message) {
  if (const auto* numbers = std::get_if<WireNumbers>(&message.body))
    return NumbersIn(stream, numbers->values);
  const auto* transform = std::get_if<WireTransform>(&message.body);
  if (transform == nullptr || !transform->T_RD.Matrix().allFinite()) return {};
  if (stream == StreamName::kWrist) return WristIn(*transform);
  if (stream == StreamName::kEm0 || stream == StreamName::kEm1) return EmIn(*transform);
  return {};
}

}  // namespace flextip::live
