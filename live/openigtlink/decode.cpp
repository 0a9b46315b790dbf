#include <fmt/format.h>
#include <igtl_header.h>
#include <igtl_util.h>

#include <algorithm>
#include <cstring>

#include "live/openigtlink/codec.h"
#include "live/openigtlink/content.h"
#include "live/protocols/reports.h"

namespace flextip::live {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHeaderSize = IGTL_HEADER_SIZE;
constexpr std::uint16_t kNewestVersion = 3;
constexpr std::size_t kLeastExtendedHeader = 12;

/// A field of fixed width: up to its first zero byte, or all of it.
std::string FieldText(const char* field, std::size_t width) {
  return {field, ::strnlen(field, width)};
}

std::uint64_t BigEndian(Bytes bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < width; ++i) value = value << 8 | bytes[at + i];
  return value;
}

/// The content between extended header and metadata, or nothing where there is no room for them.
std::optional<Bytes> WithoutExtensions(Bytes body) {
  if (body.size() < kLeastExtendedHeader) return {};
  const std::uint64_t before = BigEndian(body, 0, 2);
  const std::uint64_t behind = BigEndian(body, 2, 2) + BigEndian(body, 4, 4);
  if (before < kLeastExtendedHeader || before + behind > body.size()) return {};
  return body.subspan(before, body.size() - before - behind);
}

/// The content of a body. From version 2 on it stands between extended header and metadata; some
/// peers say 2 for protocol 2, which has none of them: only one of both fits the type's lengths.
std::optional<Bytes> ContentOf(std::uint16_t version, std::string_view type, Bytes body) {
  if (version >= 2) {
    const auto content = WithoutExtensions(body);
    if (content && ContentFits(type, *content)) return content;
  }
  if (ContentFits(type, body)) return body;
  return {};
}

std::size_t LongestBody(std::string_view type) {
  return type == "IMAGE" ? kLongestImage : kLongestBody;
}

Decoded Broken(std::string_view peer, const std::string& why) {
  return {DecodeStatus::kBroken, 0, {}, fmt::format("{}: {}", peer, why)};
}

Decoded Refused(std::string_view peer, const std::string& device, std::size_t used,
                const std::string& why) {
  return {
      DecodeStatus::kRefused, used, {}, fmt::format("{}: {}: {}", peer, Printable(device), why)};
}

}  // namespace

TimeNs TimeOfIgtlStamp(std::uint64_t stamp) {
  const std::uint64_t fraction = stamp & 0xffffffffu;
  const std::uint64_t rounded = (fraction * 1'000'000'000u + 0x80000000u) >> 32;
  // Not up to the next second: behind the last one there is none.
  constexpr std::uint64_t kLastOfSecond = 999'999'999;
  return static_cast<TimeNs>((stamp >> 32) * 1'000'000'000u + std::min(rounded, kLastOfSecond));
}

Decoded DecodeOpenIgtLink(Bytes bytes, std::string_view peer) {
  if (bytes.size() >= 2) {
    const std::uint64_t version = BigEndian(bytes, 0, 2);
    if (version < 1 || version > kNewestVersion) {
      return Broken(peer, fmt::format("sends no OpenIGTLink: found header version {}, expected 1 "
                                      "to {}",
                                      version, kNewestVersion));
    }
  }
  if (bytes.size() < kHeaderSize) return {};
  igtl_header header;
  std::memcpy(&header, bytes.data(), kHeaderSize);
  igtl_header_convert_byte_order(&header);
  const std::string type = FieldText(header.name, IGTL_HEADER_TYPE_SIZE);
  const std::string device = FieldText(header.device_name, IGTL_HEADER_NAME_SIZE);
  // Copies: nothing may refer to the fields of a packed struct.
  const std::uint64_t announced = header.body_size, expected_crc = header.crc;
  if (announced > LongestBody(type)) {
    return Broken(peer,
                  fmt::format("{}: a header of {} says {} bytes, expected at most {}",
                              Printable(device), Printable(type), announced, LongestBody(type)));
  }
  const std::size_t body_size = announced;
  if (bytes.size() - kHeaderSize < body_size) return {};
  const Bytes body = bytes.subspan(kHeaderSize, body_size);
  const std::size_t used = kHeaderSize + body_size;
  // The library's function does not write.
  const std::uint64_t crc =
      body.empty() ? 0 : crc64(const_cast<unsigned char*>(body.data()), body.size(), 0);
  if (crc != expected_crc) {
    return Refused(peer, device, used,
                   fmt::format("a {} is damaged: its check sum is {:016x}, expected {:016x}",
                               Printable(type), crc, expected_crc));
  }
  if (!IsKnownType(type)) return {DecodeStatus::kIgnored, used, {}, ""};
  const auto content = ContentOf(header.version, type, body);
  if (!content) {
    return Refused(peer, device, used,
                   fmt::format("{} bytes are no {} of a kind that can be used", body.size(), type));
  }
  ContentSink sink;
  sink.device = device;
  sink.t_ns = TimeOfIgtlStamp(header.timestamp);
  ReadContent(type, *content, sink);
  if (sink.refused.empty()) {
    return {DecodeStatus::kDone, used, std::move(sink.messages), ""};
  }
  const RefusedContent& first = sink.refused.front();
  Decoded refused =
      Refused(peer, first.device.empty() ? device : first.device, used, Printable(first.why));
  if (sink.refused.size() > 1)
    refused.why += fmt::format("; and {} more tools", sink.refused.size() - 1);
  refused.messages = std::move(sink.messages);
  return refused;
}

}  // namespace flextip::live
