#include "tests/fuzz/ros2_input.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include "core/robot/crtk.h"
#include "live/dds/messages.h"
#include "tests/live/dds/cdr.h"

namespace flextip {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

void Require(bool holds) {
  if (!holds) std::abort();
}

void CheckBody(const live::WireMessage& message) {
  if (const auto* const transform = std::get_if<live::WireTransform>(&message.body)) {
    const Eigen::Matrix3d& R = transform->T_RD.R;
    Require(transform->T_RD.p.allFinite() && R.allFinite());
    Require((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    Require(R.determinant() > 0.0);
  }
  if (const auto* const numbers = std::get_if<live::WireNumbers>(&message.body))
    for (const double value : numbers->values) Require(std::isfinite(value));
  if (const auto* const picture = std::get_if<live::WireImage>(&message.body)) {
    const Image& image = picture->image;
    Require(image.width_px > 0 && image.height_px > 0);
    Require(image.data.size() == std::size_t(image.width_px) * std::size_t(image.height_px) *
                                     std::size_t(image.channels));
  }
}

/// Whether the message is one that is sent as well: texts of states must be states, and stamps of
/// DDS itself may be later than those of ROS 2.
bool IsSent(live::Ros2Type type, const live::WireMessage& message) {
  const auto* const text = std::get_if<live::WireText>(&message.body);
  return type != live::Ros2Type::kOperatingState ||
         (text != nullptr && CrtkOperatingStateOf(text->text));
}

/// A message survives being written: time and kind stay.
void CheckAgain(live::Ros2Type type, const live::WireMessage& message) {
  if (!IsSent(type, message)) return;
  bool written = false;
  live::WithRos2(type, message, [&](const void* sample) {
    const live::Ros2Decoded again = live::DecodeRos2(type, sample, message.device, message.t_ns);
    Require(again.message.has_value() && again.why.empty());
    Require(again.message->t_ns == message.t_ns);
    Require(again.message->body.index() == message.body.index());
    CheckBody(*again.message);
    written = true;
  });
  Require(written);
}

}  // namespace

int CheckRos2Input(std::span<const std::uint8_t> input) {
  constexpr std::uint8_t kBigEndianFrom = 128;
  if (input.empty()) return 0;
  const auto type = static_cast<live::Ros2Type>(input[0] % live::kRos2Types);
  int messages = 0;
  live::WithCdr(type, input.subspan(1), input[0] >= kBigEndianFrom, [&](const void* sample) {
    const live::Ros2Decoded decoded = live::DecodeRos2(type, sample, "PSM1/measured_cp", 5);
    Require(decoded.message.has_value() == decoded.why.empty());
    for (const char c : decoded.why) Require(c >= ' ' && c <= '~');
    if (!decoded.message) return;
    Require(decoded.message->t_ns >= 0 && decoded.message->t_ns < (kSecond_ns << 31));
    CheckBody(*decoded.message);
    CheckAgain(type, *decoded.message);
    ++messages;
  });
  return messages;
}

}  // namespace flextip
