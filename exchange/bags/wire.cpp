#include "exchange/bags/wire.h"

#include <bit>

namespace flextip::exchange {

WireReader::WireReader(Bytes message, WireFormat format) : rest_(message), format_(format) {
  if (format != WireFormat::kCdr) return;
  const Bytes head = Take(4);
  if (head[0] != 0 || head[1] > 1) {
    throw WireError("is not plain CDR, as ROS 2 writes by default");
  }
  big_endian_ = head[1] == 0;
  at_ = 0;
}

Bytes WireReader::Take(std::size_t count) {
  if (count > rest_.size()) throw WireError("ends too early");
  const Bytes taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  at_ += count;
  return taken;
}

std::uint64_t WireReader::Unsigned(std::size_t size) {
  if (format_ == WireFormat::kCdr) (void)Take((size - at_ % size) % size);
  const Bytes bytes = Take(size);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t shift = 8 * (big_endian_ ? size - 1 - i : i);
    value |= static_cast<std::uint64_t>(bytes[i]) << shift;
  }
  return value;
}

double WireReader::F64() { return std::bit_cast<double>(Unsigned(8)); }

std::string WireReader::Text() {
  const Bytes bytes = Take(U32());
  std::string text(bytes.begin(), bytes.end());
  if (format_ == WireFormat::kCdr && !text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::vector<std::string> WireReader::Texts() {
  const std::uint32_t count = U32();
  std::vector<std::string> texts;
  for (std::uint32_t i = 0; i < count; ++i) texts.push_back(Text());
  return texts;
}

std::vector<double> WireReader::F64s() {
  const std::uint32_t count = U32();
  if (count > rest_.size() / 8) throw WireError("ends too early");
  return F64s(count);
}

std::vector<double> WireReader::F64s(std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(F64());
  return values;
}

Bytes WireReader::U8s() { return Take(U32()); }

}  // namespace flextip::exchange
