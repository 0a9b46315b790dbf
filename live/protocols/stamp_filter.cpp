#include "live/protocols/stamp_filter.h"

#include <functional>

namespace flextip::live {

constexpr std::size_t kMostDevices = 1024;

StampVerdict StampFilter::Judge(const WireMessage& message) {
  if (message.t_ns == 0) return StampVerdict::kPass;
  const auto* const text = std::get_if<WireText>(&message.body);
  const std::size_t hash = text != nullptr ? std::hash<std::string>{}(text->text) : 0;
  const auto known = devices_.find(message.device);
  if (known == devices_.end()) {
    if (devices_.size() >= kMostDevices) return StampVerdict::kTooManyDevices;
    devices_.emplace(message.device, Device{message.t_ns, hash});
    return StampVerdict::kPass;
  }
  Device& device = known->second;
  if (message.t_ns < device.t_ns) return StampVerdict::kOutOfOrder;
  const bool same_text = text == nullptr || hash == device.text_hash;
  if (message.t_ns == device.t_ns && same_text) return StampVerdict::kRepeated;
  device = {message.t_ns, hash};
  return StampVerdict::kPass;
}

TimeNs StampFilter::Last(const std::string& device) const {
  const auto known = devices_.find(device);
  return known == devices_.end() ? 0 : known->second.t_ns;
}

}  // namespace flextip::live
