// Values of a serialised ROS message, one after the other.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace flextip::exchange {

using Bytes = std::span<const std::uint8_t>;

/// ROS 1: packed, little-endian. ROS 2: CDR, each number aligned to its size, after four bytes that
/// name the order of bytes.
enum class WireFormat : std::uint8_t { kRos1, kCdr };

/// A message that ends too early, or of another encoding.
class WireError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Takes values off a message. Throws WireError where it ends too early.
class WireReader {
 public:
  WireReader(Bytes message, WireFormat format);

  WireFormat format() const { return format_; }
  std::uint8_t U8() { return Take(1)[0]; }
  std::uint32_t U32() { return static_cast<std::uint32_t>(Unsigned(4)); }
  std::int32_t I32() { return static_cast<std::int32_t>(U32()); }
  double F64();
  std::string Text();
  std::vector<std::string> Texts();  ///< a sequence
  std::vector<double> F64s();        ///< a sequence
  std::vector<double> F64s(std::size_t count);
  Bytes U8s();  ///< a sequence

 private:
  Bytes Take(std::size_t count);
  std::uint64_t Unsigned(std::size_t size);

  Bytes rest_;
  WireFormat format_;
  std::size_t at_ = 0;  ///< bytes since the start of the values: CDR aligns by it
  bool big_endian_ = false;
};

}  // namespace flextip::exchange
