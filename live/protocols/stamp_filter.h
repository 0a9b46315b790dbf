// Time order of each device's messages on one connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "live/wire.h"

namespace flextip::live {

enum class StampVerdict : std::uint8_t { kPass, kRepeated, kOutOfOrder, kTooManyDevices };

/// Lets messages of a device pass in strictly increasing time. Texts of one time pass where they
/// differ: two commands of one moment are two. Time 0 always passes: the peer says itself that the
/// data are invalid. At most 1024 devices.
class StampFilter {
 public:
  StampVerdict Judge(const WireMessage& message);
  /// Lets the device's next message pass, whatever its time: its sender is a new one.
  void Forget(const std::string& device) { devices_.erase(device); }
  void ForgetAll() { devices_.clear(); }
  /// Returns the time of the device's last message that passed, 0 where there was none.
  TimeNs Last(const std::string& device) const;

 private:
  struct Device {
    TimeNs t_ns = 0;
    std::size_t text_hash = 0;
  };
  std::unordered_map<std::string, Device> devices_;
};

}  // namespace flextip::live
