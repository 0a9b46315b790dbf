// Messages as the OpenIGTLink library itself packs and unpacks them: the other end of each test.
#pragma once

#include <igtlMessageHeader.h>
#include <igtl_header.h>
#include <igtl_util.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "live/openigtlink/codec.h"

namespace flextip::live {

inline constexpr TimeNs kStamp_ns = 1'700'000'000'123'456'789;

/// Writes an integer, most significant byte first.
inline void Put(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint64_t value,
                std::size_t width) {
  for (std::size_t i = 0; i < width; ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (width - 1 - i)));
}

/// Writes the length and the check sum that belong to the body.
inline void Seal(std::vector<std::uint8_t>& bytes) {
  Put(bytes, 42, bytes.size() - IGTL_HEADER_SIZE, 8);
  Put(bytes, 50, crc64(bytes.data() + IGTL_HEADER_SIZE, bytes.size() - IGTL_HEADER_SIZE, 0), 8);
}

/// Returns the message's bytes, stamped with kStamp_ns.
template <class Pointer>
std::vector<std::uint8_t> Packed(Pointer& message, const char* device) {
  const std::uint64_t stamp = IgtlStamp(kStamp_ns);
  message->SetDeviceName(device);
  message->SetTimeStamp(static_cast<unsigned>(stamp >> 32), static_cast<unsigned>(stamp));
  message->Pack();
  const auto* const bytes = static_cast<const std::uint8_t*>(message->GetPackPointer());
  return {bytes, bytes + message->GetPackSize()};
}

/// Unpacks bytes with the library's check of the sum. Returns null where it fails.
template <class Message>
typename Message::Pointer Unpacked(const std::vector<std::uint8_t>& bytes) {
  auto header = igtl::MessageHeader::New();
  header->InitPack();
  std::memcpy(header->GetPackPointer(), bytes.data(),
              static_cast<std::size_t>(header->GetPackSize()));
  header->Unpack();
  auto message = Message::New();
  message->SetMessageHeader(header);
  message->AllocatePack();
  std::memcpy(message->GetPackBodyPointer(), bytes.data() + header->GetPackSize(),
              static_cast<std::size_t>(message->GetPackBodySize()));
  if ((message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) == 0) return nullptr;
  return message;
}

}  // namespace flextip::live
