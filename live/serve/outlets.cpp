#include "live/serve/outlets.h"

#include <fmt/format.h>

#include <utility>

#include "live/serve/messages.h"

namespace flextip::live {
namespace {

constexpr std::chrono::milliseconds kSettle{20};

Ros2Topic Topic(const char* name, Content content) { return {name, Ros2TypesFor(content)}; }

WireCounts Sum(const WireCounts& a, const WireCounts& b) {
  return {a.passed + b.passed,   a.repeated + b.repeated, a.out_of_order + b.out_of_order,
          a.refused + b.refused, a.ignored + b.ignored,   a.unsent + b.unsent};
}

}  // namespace

Outlets::Outlets(const ServeOptions& options,
                 const std::function<void(Source, WireMessage&&)>& message,
                 const std::function<void(WireEvent&&)>& event)
    : options_(options),
      server_(
          options.port, options.any_address,
          [message](WireMessage&& m) { message(Source::kOpenIgtLink, std::move(m)); }, event) {
  if (options.udp_port) udp_.emplace(*options.udp_port);
  if (options.ros2_domain) {
    node_.emplace(
        RosSetup(*options.ros2_domain),
        [message](WireMessage&& m) { message(Source::kRos2, std::move(m)); }, event);
  }
}

Ros2Setup Outlets::RosSetup(int domain) const {
  Ros2Setup setup;
  setup.domain = domain;
  if (options_.any_address) setup.network.clear();
  setup.lockstep = options_.lockstep;
  setup.one_commander = true;
  setup.says_invalid = false;
  if (options_.lockstep) {
    setup.out.push_back(Topic(kLockstepDevice, Content::kText));
    setup.last_out = 0;
  }
  setup.out.push_back(Topic(kMeasuredDevice, Content::kPose));
  setup.out.push_back(Topic("em0", Content::kPose));
  setup.out.push_back(Topic("em1", Content::kPose));
  setup.out.push_back(Topic("strain0", Content::kMoments));
  setup.out.push_back(Topic("load0", Content::kForce));
  setup.out.push_back(Topic("vision0", Content::kTip));
  setup.out.push_back(Topic("cam0", Content::kPicture));
  setup.out.push_back(Topic(kStateDevice, Content::kState));
  if (options_.lockstep) setup.last_in = 0;  // state commands of a cycle come before its set-point
  setup.in.push_back(Topic(kServoDevice, Content::kPose));
  setup.in.push_back(Topic(kInterpolateDevice, Content::kPose));
  setup.in.push_back(Topic(kCommandDevice, Content::kText));
  return setup;
}

bool Outlets::IsHeard(Source source) {
  if (source != commander_ && HasCommander(commander_)) return false;
  commander_ = source;
  return true;
}

bool Outlets::Send(const WireMessage& message) {
  if (udp_ && std::holds_alternative<WireTransform>(message.body)) (void)udp_->Send(message);
  bool heard = node_ && node_->Send(message);
  heard |= server_.Send(message, options_.lockstep) > 0;
  return heard;
}

bool Outlets::Settled() const {
  return !node_ || !HasRosClient() || node_->WaitForReaders(kSettle);
}

bool Outlets::HasRosClient() const {
  if (!node_ || !node_->IsThere(kLockstepDevice)) return false;
  return node_->IsThere(kServoDevice) || node_->IsThere(kInterpolateDevice);
}

int Outlets::Clients() const { return server_.Clients() + (HasRosClient() ? 1 : 0); }

bool Outlets::HasCommander(Source source) const {
  if (source == Source::kOpenIgtLink) return server_.HasCommander();
  return source == Source::kRos2 && node_ && node_->HasCommander();
}

WireCounts Outlets::Counts() const {
  return node_ ? Sum(server_.Counts(), node_->Counts()) : server_.Counts();
}

}  // namespace flextip::live
