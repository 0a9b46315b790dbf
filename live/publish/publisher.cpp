#include "live/publish/publisher.h"

#include <utility>

#include "core/rotation.h"
#include "pipeline/estimated_shape.h"

namespace flextip::live {
namespace {

constexpr int kShaftPoints = 40;
constexpr double kPerMetre_mm = 1e3;

Pose TipOf(const ShaftEstimate& estimate) {
  return {RotationWithoutTwist(Eigen::Vector3d::UnitX(), estimate.d_RE), estimate.p_RE};
}

WireNumbers CovarianceOf(const ShaftEstimate& estimate) {
  WireNumbers numbers;
  for (int i = 0; i < 9; ++i) {
    numbers.values.push_back(kPerMetre_mm * kPerMetre_mm *
                             estimate.p_RE_covariance_m2(i / 3, i % 3));
  }
  return numbers;
}

bool HasTip(const ShaftEstimate& estimate) {
  return (estimate.status == EstimateStatus::kOk ||
          estimate.status == EstimateStatus::kUnobservable) &&
         estimate.p_RE.allFinite() && estimate.p_RE_covariance_m2.allFinite();
}

}  // namespace

Publisher::Publisher(const Session& session)
    : setup_(*session.publish),
      server_(
          setup_.port, setup_.any_address, [](WireMessage&&) {}, [](WireEvent&&) {}),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

Publisher::~Publisher() { thread_ = {}; }

void Publisher::TakePicture(TimeNs t_ns, const Image& picture) {
  if (server_.Clients() == 0) return;
  const std::lock_guard lock(picture_mutex_);
  picture_ = {"cam0", t_ns, WireImage{picture}};
}

void Publisher::Run(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any nobody;
  const std::chrono::duration<double> period(1.0 / setup_.rate_hz);
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex);
    nobody.wait_for(lock, stop, period, [] { return false; });
    if (server_.Clients() == 0) continue;
    if (const ControllerCommand* command = newest_.Look()) Send(*command);
    SendPicture();
  }
}

void Publisher::Send(const ControllerCommand& command) {
  if (command.t_ns <= sent_ns_ || command.status == ControlStatus::kNoWrist) return;
  sent_ns_ = command.t_ns;
  const Measurements& z = command.measurements;
  const Eigen::Matrix3d R_RW = z.R_RW.value_or(Eigen::Matrix3d::Identity());
  server_.Send({"wrist", command.t_ns, WireTransform{{R_RW, z.p_RW}, z.R_RW.has_value()}});
  if (!HasTip(command.estimate)) return;
  server_.Send({"tip", command.t_ns, WireTransform{TipOf(command.estimate)}});
  server_.Send({"tip_covariance", command.t_ns, CovarianceOf(command.estimate)});
  WireLine shaft;
  for (const ShapePoint& point : EstimatedShape(command.estimate, z.p_RW, kShaftPoints))
    shaft.points.push_back(point.p_R);
  if (!shaft.points.empty()) server_.Send({"shaft", command.t_ns, std::move(shaft)});
}

void Publisher::SendPicture() {
  WireMessage picture;
  {
    const std::lock_guard lock(picture_mutex_);
    picture = std::exchange(picture_, {});
  }
  if (!picture.device.empty()) server_.Send(picture);
}

}  // namespace flextip::live
