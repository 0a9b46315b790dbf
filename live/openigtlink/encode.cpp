#include <fmt/format.h>
#include <igtl_header.h>
#include <igtl_image.h>
#include <igtl_ndarray.h>
#include <igtl_string.h>
#include <igtl_transform.h>
#include <igtl_util.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "live/openigtlink/codec.h"

namespace flextip::live {
namespace {

constexpr double kMillimetresPerMetre = 1e3;
constexpr TimeNs kLastTime_ns = 4'294'967'295'999'999'999;  // in 2106
constexpr std::size_t kMostOfSize = std::numeric_limits<std::uint16_t>::max();

/// A whole message under construction: room for the header, then the body.
struct Packet {
  const char* type = "";
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(IGTL_HEADER_SIZE);

  void Add(const void* from, std::size_t size) {
    const auto* const begin = static_cast<const std::uint8_t*>(from);
    bytes.insert(bytes.end(), begin, begin + size);
  }
  void AddUnsigned(std::uint64_t value, int width) {
    for (int shift = 8 * (width - 1); shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
};

[[noreturn]] void Refuse(const std::string& device, const std::string& why) {
  throw InputError(fmt::format("OpenIGTLink message {}: {}", device, why));
}

Packet Pack(const WireTransform& body, const std::string& device) {
  igtl_float32 values[12];
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      values[3 * column + row] = static_cast<float>(body.T_RD.R(row, column));
  for (int row = 0; row < 3; ++row)
    values[9 + row] = static_cast<float>(kMillimetresPerMetre * body.T_RD.p[row]);
  for (const float value : values)
    if (!std::isfinite(value)) Refuse(device, fmt::format("found {} in its pose", value));
  igtl_transform_convert_byte_order(values);
  Packet packet{"TRANSFORM"};
  packet.Add(values, sizeof values);
  return packet;
}

Packet Pack(const WireNumbers& body, const std::string& device) {
  if (body.values.size() > kMostOfSize) {
    Refuse(device,
           fmt::format("found {} numbers, expected at most {}", body.values.size(), kMostOfSize));
  }
  Packet packet{"NDARRAY"};
  packet.AddUnsigned(IGTL_NDARRAY_STYPE_TYPE_FLOAT64, 1);
  packet.AddUnsigned(1, 1);
  packet.AddUnsigned(body.values.size(), 2);
  for (const double value : body.values) {
    if (!std::isfinite(value)) Refuse(device, fmt::format("found {} among its numbers", value));
    packet.AddUnsigned(std::bit_cast<std::uint64_t>(value), 8);
  }
  return packet;
}

Packet Pack(const WireText& body, const std::string& device) {
  if (body.text.size() > kMostOfSize) {
    Refuse(device, fmt::format("found {} bytes of text, expected at most {}", body.text.size(),
                               kMostOfSize));
  }
  constexpr std::uint16_t kAscii = 3;
  igtl_string_header header{kAscii, static_cast<igtl_uint16>(body.text.size())};
  igtl_string_convert_byte_order(&header);
  Packet packet{"STRING"};
  packet.Add(&header, sizeof header);
  packet.Add(body.text.data(), body.text.size());
  return packet;
}

Packet Pack(const WireImage& body, const std::string& device) {
  const Image& image = body.image;
  const bool channels = image.channels == 1 || image.channels == 3;
  const auto fits = [](int size) { return size > 0 && size <= int{kMostOfSize}; };
  if (!channels || !fits(image.width_px) || !fits(image.height_px) ||
      image.data.size() + IGTL_IMAGE_HEADER_SIZE > kLongestImage) {
    Refuse(device, fmt::format("found a picture of {} x {} pixels and {} channels", image.width_px,
                               image.height_px, image.channels));
  }
  igtl_image_header header{};
  header.version = IGTL_IMAGE_HEADER_VERSION;
  header.num_components = static_cast<igtl_uint8>(image.channels);
  header.scalar_type = IGTL_IMAGE_STYPE_TYPE_UINT8;
  header.endian = IGTL_IMAGE_ENDIAN_LITTLE;
  header.coord = IGTL_IMAGE_COORD_RAS;
  header.size[0] = header.subvol_size[0] = static_cast<igtl_uint16>(image.width_px);
  header.size[1] = header.subvol_size[1] = static_cast<igtl_uint16>(image.height_px);
  header.size[2] = header.subvol_size[2] = 1;
  header.matrix[0] = header.matrix[4] = header.matrix[8] = 1.0f;  // pixels of 1 mm
  igtl_image_convert_byte_order(&header);
  Packet packet{"IMAGE"};
  packet.bytes.reserve(packet.bytes.size() + sizeof header + image.data.size());
  packet.Add(&header, sizeof header);
  packet.Add(image.data.data(), image.data.size());
  return packet;
}

Packet Pack(const WireLine& body, const std::string& device) {
  const std::size_t count = body.points.size();
  if (count < 2 || count > kMostOfSize)
    Refuse(device, fmt::format("found a line of {} points, expected 2 to {}", count, kMostOfSize));
  Packet packet{"POLYDATA"};
  const std::uint64_t lines_size = 4 * (1 + count);
  // Points; vertices and their size; lines and their size; polygons, strips, attributes.
  for (const std::uint64_t value :
       {std::uint64_t{count}, std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{1}, lines_size,
        std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{0}})
    packet.AddUnsigned(value, 4);
  for (const Eigen::Vector3d& point : body.points) {
    for (int i = 0; i < 3; ++i) {
      const auto value = static_cast<float>(kMillimetresPerMetre * point[i]);
      if (!std::isfinite(value)) Refuse(device, fmt::format("found {} in its line", value));
      packet.AddUnsigned(std::bit_cast<std::uint32_t>(value), 4);
    }
  }
  packet.AddUnsigned(count, 4);
  for (std::size_t i = 0; i < count; ++i) packet.AddUnsigned(i, 4);
  return packet;
}

}  // namespace

std::uint64_t IgtlStamp(TimeNs t_ns) {
  const auto t = static_cast<std::uint64_t>(t_ns);
  const std::uint64_t seconds = t / 1'000'000'000u, rest = t % 1'000'000'000u;
  return seconds << 32 | ((rest << 32) + 500'000'000u) / 1'000'000'000u;
}

std::vector<std::uint8_t> EncodeOpenIgtLink(const WireMessage& message) {
  if (message.device.empty() || message.device.size() > IGTL_HEADER_NAME_SIZE) {
    Refuse(message.device, fmt::format("found a name of {} bytes, expected 1 to {}",
                                       message.device.size(), IGTL_HEADER_NAME_SIZE));
  }
  if (message.t_ns < 0 || message.t_ns > kLastTime_ns) {
    Refuse(message.device,
           fmt::format("found the time {} ns, expected 0 to {}", message.t_ns, kLastTime_ns));
  }
  Packet packet =
      std::visit([&](const auto& body) { return Pack(body, message.device); }, message.body);
  igtl_header header{};
  header.version = IGTL_HEADER_VERSION;
  std::memcpy(header.name, packet.type, std::strlen(packet.type));
  std::memcpy(header.device_name, message.device.data(), message.device.size());
  header.timestamp = IgtlStamp(message.t_ns);
  header.body_size = packet.bytes.size() - IGTL_HEADER_SIZE;
  if (header.body_size > 0)
    header.crc = crc64(packet.bytes.data() + IGTL_HEADER_SIZE, header.body_size, 0);
  igtl_header_convert_byte_order(&header);
  std::memcpy(packet.bytes.data(), &header, sizeof header);
  return std::move(packet.bytes);
}

}  // namespace flextip::live
