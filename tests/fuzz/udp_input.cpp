#include "tests/fuzz/udp_input.h"

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "live/udp/listener.h"
#include "live/udp/sender.h"

namespace flextip {
namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

/// A pose is finite, and survives being sent but for the time, which is seconds as a double.
void CheckPose(const live::WireMessage& message) {
  constexpr TimeNs kRounding_ns = 2000;  // in the year 2255
  const auto* const transform = std::get_if<live::WireTransform>(&message.body);
  Require(transform != nullptr && message.t_ns >= 0);
  Require(transform->T_RD.p.allFinite() && transform->T_RD.R.allFinite());
  std::string problem;
  const auto again = live::PosesInJson(live::PoseAsJson(message), problem);
  Require(again.size() == 1 && problem.empty());
  const auto& T_RD = std::get<live::WireTransform>(again[0].body).T_RD;
  Require(T_RD.p == transform->T_RD.p && T_RD.R == transform->T_RD.R);
  Require(std::abs(again[0].t_ns - message.t_ns) <= kRounding_ns);
}

}  // namespace

int CheckUdpInput(std::span<const std::uint8_t> input) {
  // A copy of exactly this size: a sanitizer sees what reads beyond it.
  const std::vector<char> bytes(input.begin(), input.end());
  std::string problem;
  const auto poses = live::PosesInJson({bytes.data(), bytes.size()}, problem);
  Require(poses.empty() != problem.empty());
  for (const char c : problem) Require(c >= ' ');
  for (const live::WireMessage& pose : poses) CheckPose(pose);
  return static_cast<int>(poses.size());
}

}  // namespace flextip
