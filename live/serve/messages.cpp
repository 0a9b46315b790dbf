#include "live/serve/messages.h"

#include <string>

namespace flextip::live {
namespace {

using Body = decltype(WireMessage::body);

constexpr double kMillimetresPerMetre = 1e3;

struct NamedBody {
  std::string device;
  Body body;
};

template <class Vector>
WireNumbers Numbers(const Vector& v) {
  return {{v.data(), v.data() + v.size()}};
}

struct ToMessage {
  double direction_noise_rad;

  std::optional<NamedBody> operator()(const WristSample& wrist) const {
    const Eigen::Quaterniond q = wrist.q_RW.value_or(Eigen::Quaterniond::Identity());
    return NamedBody{kMeasuredDevice, WireTransform{Pose::FromQuaternion(q, wrist.p_RW)}};
  }
  std::optional<NamedBody> operator()(const simulation::EmReading& em) const {
    return NamedBody{em.sensor == 0 ? "em0" : "em1",
                     WireTransform{Pose::FromQuaternion(em.sample.q_RS, em.sample.p_RS)}};
  }
  std::optional<NamedBody> operator()(const simulation::StrainReading& strain) const {
    return NamedBody{"strain0", Numbers(strain.moments_Nm)};
  }
  std::optional<NamedBody> operator()(const simulation::ForceReading& force) const {
    return NamedBody{"load0", Numbers(force.f_tip_N)};
  }
  std::optional<NamedBody> operator()(const TipObservation& tip) const {
    if (tip.status == TipStatus::kLost) return {};
    return NamedBody{"vision0", TipNumbers(tip, direction_noise_rad)};
  }
  std::optional<NamedBody> operator()(const simulation::PictureDue&) const { return {}; }
  std::optional<NamedBody> operator()(const CrtkOperatingState& state) const {
    return NamedBody{kStateDevice, WireText{Text(state)}};
  }
};

}  // namespace

WireNumbers TipNumbers(const TipObservation& tip, double direction_noise_rad) {
  WireNumbers numbers;
  for (int i = 0; i < 3; ++i) numbers.values.push_back(kMillimetresPerMetre * tip.p_RE[i]);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      numbers.values.push_back(kMillimetresPerMetre * kMillimetresPerMetre *
                               tip.covariance_m2(row, column));
    }
  const Eigen::Vector3d direction = tip.d_RE.value_or(Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i) numbers.values.push_back(direction[i]);
  numbers.values.push_back(direction_noise_rad);
  return numbers;
}

std::optional<WireMessage> MessageOf(const simulation::VirtualSample& sample,
                                     double direction_noise_rad, TimeNs offset_ns) {
  auto named = std::visit(ToMessage{direction_noise_rad}, sample.value);
  if (!named) return {};
  return WireMessage{std::move(named->device), sample.t_ns + offset_ns, std::move(named->body)};
}

}  // namespace flextip::live
