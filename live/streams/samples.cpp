#include "live/streams/samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "live/session/plausible.h"

namespace flextip::live {
namespace {

constexpr double kUnitTolerance = 1e-3;
constexpr double kPerMillimetre = 1e-3;
constexpr Plausible kMoment{0.0, 100.0, "N m"};
constexpr Plausible kForce{0.0, 1000.0, "N"};

bool IsRotation(const Eigen::Matrix3d& R) {
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return off <= kUnitTolerance && R.determinant() > 0;
}

/// Whether the vector's length is plausible; says why not.
template <class Vector>
bool IsIn(const Plausible& range, const Vector& v, const char* what, std::string& why) {
  if (v.norm() <= range.most) return true;
  why = fmt::format("found a {} of {:.6g} {}, expected at most {:g} {}: is it in another unit?",
                    what, v.norm(), range.unit, range.most, range.unit);
  return false;
}

bool IsRotated(const WireTransform& body, std::string& why) {
  if (IsRotation(body.T_RD.R)) return true;
  const Eigen::Matrix3d off = body.T_RD.R.transpose() * body.T_RD.R - Eigen::Matrix3d::Identity();
  why = fmt::format(
      "found a matrix that is off a rotation by {:.3g} (determinant {:.6g}), expected "
      "at most {:g}",
      off.cwiseAbs().maxCoeff(), body.T_RD.R.determinant(), kUnitTolerance);
  return false;
}

std::optional<AnySample> WristIn(const WireTransform& body, std::string& why) {
  WristSample sample{body.T_RD.p, {}};
  if (body.has_orientation) {
    if (!IsRotated(body, why)) return {};
    sample.q_RW = body.T_RD.Quaternion();
  }
  return sample;
}

std::optional<AnySample> EmIn(const WireTransform& body, std::string& why) {
  if (!body.has_orientation) {
    why = "found no orientation, expected one";
    return {};
  }
  if (!IsRotated(body, why)) return {};
  return EmSample{body.T_RD.p, body.T_RD.Quaternion()};
}

/// p (mm), covariance row by row (mm^2), direction (unit; zeros: not seen), its noise (rad).
std::optional<AnySample> TipIn(const std::vector<double>& v, std::string& why) {
  SeenTip seen;
  seen.tip.status = TipStatus::kOk;
  for (int i = 0; i < 3; ++i) seen.tip.p_RE[i] = kPerMillimetre * v[i];
  for (int i = 0; i < 9; ++i)
    seen.tip.covariance_m2(i / 3, i % 3) = kPerMillimetre * kPerMillimetre * v[3 + i];
  seen.tip.covariance_m2 =
      (0.5 * (seen.tip.covariance_m2 + seen.tip.covariance_m2.transpose())).eval();
  if (!IsIn(kPlace, seen.tip.p_RE, "position", why)) return {};
  const double least_m2 = SymmetricEigenvalues(seen.tip.covariance_m2)(0);
  if (!(least_m2 >= 0.0)) {
    why = fmt::format("found a covariance with the eigenvalue {:.6g} m2, expected none below 0",
                      least_m2);
    return {};
  }
  const Eigen::Vector3d d(v[12], v[13], v[14]);
  if (d.norm() > 0.0) {
    if (std::abs(d.norm() - 1.0) > kUnitTolerance || v[15] < 0.0) {
      why = fmt::format(
          "found a direction of length {:.6g} and noise {:.6g} rad, expected 1 and "
          "no less than 0",
          d.norm(), v[15]);
      return {};
    }
    seen.tip.d_RE = d.normalized();
    seen.direction_noise_rad = v[15];
  }
  return seen;
}

/// How many numbers a message of the stream has; 0: it has none.
std::size_t CountOf(StreamName stream) {
  constexpr std::size_t kTip = 16, kStrain = 4, kLoad = 3;
  if (stream == StreamName::kTip) return kTip;
  if (stream == StreamName::kStrain) return kStrain;
  return stream == StreamName::kLoad ? kLoad : 0;
}

std::optional<AnySample> NumbersIn(StreamName stream, const std::vector<double>& v,
                                   std::string& why) {
  const std::size_t count = CountOf(stream);
  if (count == 0 || v.size() != count) {
    why = fmt::format("found {} numbers, expected {}", v.size(),
                      count == 0 ? "a pose" : fmt::format("{}", count));
    return {};
  }
  const auto odd = std::find_if_not(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
  if (odd != v.end()) {
    why = fmt::format("found {}, expected finite numbers", *odd);
    return {};
  }
  if (stream == StreamName::kTip) return TipIn(v, why);
  if (stream == StreamName::kStrain) {
    const Eigen::Vector4d moments_Nm(v[0], v[1], v[2], v[3]);
    if (!IsIn(kMoment, moments_Nm, "moment", why)) return {};
    return moments_Nm;
  }
  const Eigen::Vector3d force_N(v[0], v[1], v[2]);
  if (!IsIn(kForce, force_N, "force", why)) return {};
  return force_N;
}

}  // namespace

std::optional<AnySample> SampleIn(StreamName stream, const WireMessage& message, std::string& why) {
  if (const auto* numbers = std::get_if<WireNumbers>(&message.body))
    return NumbersIn(stream, numbers->values, why);
  const auto* transform = std::get_if<WireTransform>(&message.body);
  if (transform == nullptr || CountOf(stream) != 0) {
    why =
        fmt::format("found {}, expected {}", transform == nullptr ? "a text or picture" : "a pose",
                    CountOf(stream) == 0 ? "a pose" : "numbers");
    return {};
  }
  if (!transform->T_RD.Matrix().allFinite()) {
    why = "found a pose that is not finite";
    return {};
  }
  if (!IsIn(kPlace, transform->T_RD.p, "position", why)) return {};
  return stream == StreamName::kWrist ? WristIn(*transform, why) : EmIn(*transform, why);
}

}  // namespace flextip::live
