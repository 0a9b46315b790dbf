#include "tests/fuzz/openigtlink_input.h"

#include <igtl_header.h>
#include <igtl_util.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "live/openigtlink/codec.h"

namespace flextip {
namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

void Put(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (7 - i)));
}

/// What every message must be, and that it survives encoding.
void CheckMessage(const live::WireMessage& message) {
  Require(message.t_ns >= 0 && message.device.size() <= IGTL_HEADER_NAME_SIZE);
  if (const auto* const transform = std::get_if<live::WireTransform>(&message.body)) {
    const Eigen::Matrix3d& R = transform->T_RD.R;
    Require(transform->T_RD.p.allFinite() && R.allFinite());
    Require((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12);
    Require(R.determinant() > 0.0);
  }
  if (const auto* const numbers = std::get_if<live::WireNumbers>(&message.body)) {
    for (const double value : numbers->values) Require(std::isfinite(value));
    if (numbers->values.size() > 65535) return;  // of several dimensions: cannot be sent as one
  }
  if (const auto* const text = std::get_if<live::WireText>(&message.body))
    if (text->text.size() > 65535) return;  // a STATUS may be longer than a STRING
  if (message.device.empty()) return;       // may come, but is not sent
  const auto bytes = live::EncodeOpenIgtLink(message);
  const live::Decoded again = live::DecodeOpenIgtLink(bytes, "again");
  Require(again.status == live::DecodeStatus::kDone && again.messages.size() == 1);
  Require(again.messages[0].t_ns == message.t_ns && again.messages[0].device == message.device);
}

}  // namespace

int CheckOpenIgtLinkInput(std::span<const std::uint8_t> input) {
  if (input.empty()) return 0;
  std::vector<std::uint8_t> bytes(input.begin() + 1, input.end());
  if (input[0] % 2 == 1 && bytes.size() >= IGTL_HEADER_SIZE) {
    const std::size_t size = bytes.size() - IGTL_HEADER_SIZE;
    Put(bytes, 42, size);
    Put(bytes, 50, size > 0 ? crc64(bytes.data() + IGTL_HEADER_SIZE, size, 0) : 0);
  }
  int messages = 0;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const live::Decoded decoded =
        live::DecodeOpenIgtLink(std::span(bytes).subspan(at), "127.0.0.1:1");
    const bool ends = decoded.status == live::DecodeStatus::kMore ||
                      decoded.status == live::DecodeStatus::kBroken;
    Require(ends == (decoded.used == 0) && decoded.used <= bytes.size() - at);
    Require(!ends || decoded.messages.empty());
    const bool explains = decoded.status == live::DecodeStatus::kRefused ||
                          decoded.status == live::DecodeStatus::kBroken;
    Require(explains == !decoded.why.empty());
    for (const char c : decoded.why) Require(c >= ' ');
    for (const live::WireMessage& message : decoded.messages) CheckMessage(message);
    messages += static_cast<int>(decoded.messages.size());
    if (ends) break;
    at += decoded.used;
  }
  return messages;
}

}  // namespace flextip
