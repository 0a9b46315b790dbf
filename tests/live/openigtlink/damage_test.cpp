// Bytes that are damaged, cut off, or say what is not so.
#include <gmock/gmock.h>

#include <random>

#include "core/rotation.h"
#include "live/openigtlink/codec.h"
#include "tests/live/openigtlink/peer_messages.h"

namespace flextip::live {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

constexpr TimeNs kTime_ns = 1'700'000'000'000'000'001;
const char* const kPeer = "10.0.0.7:18944";

/// One message of each kind.
std::vector<Bytes> Samples() {
  Image image(6, 4, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<std::uint8_t>(i);
  const Pose pose{ExpRotation(Eigen::Vector3d(0.1, 0.2, 0.3)), {0.1, 0.2, 0.3}};
  return {EncodeOpenIgtLink({"PSM1/measured_cp", kTime_ns, WireTransform{pose}}),
          EncodeOpenIgtLink({"strain0", kTime_ns, WireNumbers{{1.0, 2.0, 3.0, 4.0}}}),
          EncodeOpenIgtLink({"PSM1/operating_state", kTime_ns, WireText{"PAUSED homed"}}),
          EncodeOpenIgtLink({"cam0", kTime_ns, WireImage{image}})};
}

TEST(DamagedOpenIgtLink, IsNeverReadWhereItEndsEarly) {
  for (const Bytes& whole : Samples()) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      // A copy of exactly this size: a sanitizer sees what reads beyond it.
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const Decoded decoded = DecodeOpenIgtLink(cut, kPeer);
      ASSERT_EQ(decoded.status, DecodeStatus::kMore) << size;
      ASSERT_EQ(decoded.used, 0u);
      ASSERT_TRUE(decoded.messages.empty());
    }
    EXPECT_EQ(DecodeOpenIgtLink(whole, kPeer).status, DecodeStatus::kDone);
  }
}

TEST(DamagedOpenIgtLink, BodiesWithAFlippedBitAreRefused) {
  for (const Bytes& whole : Samples()) {
    for (std::size_t bit = 8 * IGTL_HEADER_SIZE; bit < 8 * whole.size(); ++bit) {
      Bytes flipped = whole;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      const Decoded decoded = DecodeOpenIgtLink(flipped, kPeer);
      ASSERT_EQ(decoded.status, DecodeStatus::kRefused);
      ASSERT_EQ(decoded.used, whole.size());
      ASSERT_THAT(decoded.why, HasSubstr("check sum"));
    }
  }
}

TEST(DamagedOpenIgtLink, HeadersWithAFlippedBitNeverGiveOtherValues) {
  for (const Bytes& whole : Samples()) {
    for (std::size_t bit = 0; bit < 8 * IGTL_HEADER_SIZE; ++bit) {
      Bytes flipped = whole;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      const Decoded decoded = DecodeOpenIgtLink(flipped, kPeer);
      // The sum is of the body alone: version, names and time can change, the content cannot.
      if (decoded.status != DecodeStatus::kDone) continue;
      ASSERT_EQ(decoded.messages.size(), 1u);
      WireMessage read = decoded.messages[0];
      const WireMessage original = DecodeOpenIgtLink(whole, kPeer).messages[0];
      ASSERT_EQ(read.body.index(), original.body.index());
      read.device = original.device;
      read.t_ns = original.t_ns;
      ASSERT_EQ(EncodeOpenIgtLink(read), EncodeOpenIgtLink(original));
    }
  }
}

TEST(DamagedOpenIgtLink, LengthsOfHeadersAreCheckedBeforeMemoryIsTaken) {
  for (Bytes bytes : Samples()) {
    for (const std::uint64_t size :
         {std::uint64_t{kLongestImage} + 1, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
      Put(bytes, 42, size, 8);
      const Decoded decoded = DecodeOpenIgtLink(bytes, kPeer);
      EXPECT_EQ(decoded.status, DecodeStatus::kBroken);
      EXPECT_THAT(decoded.why, HasSubstr(std::to_string(size)));
    }
    const auto type = std::string(reinterpret_cast<const char*>(&bytes[2]));
    Put(bytes, 42, kLongestBody + 1, 8);
    EXPECT_EQ(DecodeOpenIgtLink(bytes, kPeer).status,
              type == "IMAGE" ? DecodeStatus::kMore : DecodeStatus::kBroken);
  }
}

TEST(DamagedOpenIgtLink, LengthsThatDisagreeWithTheTypeAreRefused) {
  for (const Bytes& whole : Samples()) {
    for (const int change : {-1, 1, 8}) {
      Bytes bytes = whole;
      bytes.resize(static_cast<std::size_t>(static_cast<int>(bytes.size()) + change));
      Seal(bytes);
      EXPECT_EQ(DecodeOpenIgtLink(bytes, kPeer).status, DecodeStatus::kRefused) << change;
    }
  }
}

TEST(DamagedOpenIgtLink, LengthsInsideTheBodyAreRefused) {
  const std::vector<Bytes> samples = Samples();
  const std::size_t body = IGTL_HEADER_SIZE;
  struct Lie {
    std::size_t sample, at;
    std::uint64_t value;
    std::size_t width;
  };
  const std::vector<Lie> lies = {
      {1, body + 1, 255, 1},   {1, body + 1, 0, 1},      {1, body + 2, 65535, 2},
      {1, body + 2, 5, 2},     {1, body, 13, 1},         {1, body, 99, 1},
      {2, body + 2, 65535, 2}, {2, body + 2, 3, 2},      {3, body + 6, 65535, 2},
      {3, body + 8, 65535, 2}, {3, body + 10, 65535, 2}, {3, body + 2, 200, 1},
      {3, body + 3, 11, 1},    {3, body + 60, 1, 2},     {3, body + 66, 65535, 2}};
  for (const Lie& lie : lies) {
    Bytes bytes = samples[lie.sample];
    Put(bytes, lie.at, lie.value, lie.width);
    Seal(bytes);
    EXPECT_EQ(DecodeOpenIgtLink(bytes, kPeer).status, DecodeStatus::kRefused)
        << lie.sample << " " << lie.at << " " << lie.value;
  }
}

/// A body of version 2 or 3: extended header of 12 bytes, content, metadata.
Bytes Extended(const Bytes& whole, unsigned version, std::size_t metadata_head,
               std::size_t metadata) {
  Bytes bytes(whole.begin(), whole.begin() + IGTL_HEADER_SIZE);
  Bytes extension(12);
  Put(extension, 0, 12, 2);
  Put(extension, 2, metadata_head, 2);
  Put(extension, 4, metadata, 4);
  Put(extension, 8, 4711, 4);
  bytes.insert(bytes.end(), extension.begin(), extension.end());
  bytes.insert(bytes.end(), whole.begin() + IGTL_HEADER_SIZE, whole.end());
  bytes.insert(bytes.end(), metadata_head + metadata, 'm');
  Put(bytes, 0, version, 2);
  Seal(bytes);
  return bytes;
}

TEST(OpenIgtLinkVersions, ExtendedHeadersAndMetadataAreSkipped) {
  for (const Bytes& whole : Samples()) {
    const WireMessage original = DecodeOpenIgtLink(whole, kPeer).messages[0];
    for (const unsigned version : {2u, 3u}) {
      for (const std::size_t metadata : {0, 10}) {
        const Bytes bytes = Extended(whole, version, metadata > 0 ? 8 : 2, metadata);
        const Decoded decoded = DecodeOpenIgtLink(bytes, kPeer);
        ASSERT_EQ(decoded.status, DecodeStatus::kDone) << decoded.why;
        EXPECT_EQ(decoded.used, bytes.size());
        EXPECT_EQ(EncodeOpenIgtLink(decoded.messages[0]), EncodeOpenIgtLink(original));
      }
      Bytes plain = whole;
      Put(plain, 0, version, 2);
      EXPECT_EQ(DecodeOpenIgtLink(plain, kPeer).status, DecodeStatus::kDone);
    }
    for (const unsigned version : {0u, 4u, 18245u}) {
      Bytes bytes = whole;
      Put(bytes, 0, version, 2);
      EXPECT_EQ(DecodeOpenIgtLink(bytes, kPeer).status, DecodeStatus::kBroken);
    }
  }
}

TEST(OpenIgtLinkVersions, LiesOfExtendedHeadersAreRefused) {
  const Bytes sound = Extended(Samples()[0], 2, 2, 0);
  for (const std::uint64_t size : {0u, 11u, 13u, 65535u}) {
    Bytes bytes = sound;
    Put(bytes, IGTL_HEADER_SIZE, size, 2);
    Seal(bytes);
    EXPECT_EQ(DecodeOpenIgtLink(bytes, kPeer).status, DecodeStatus::kRefused) << size;
  }
  for (const std::uint64_t size : {1u, 1000u, 0xffffffffu}) {
    Bytes bytes = sound;
    Put(bytes, IGTL_HEADER_SIZE + 4, size, 4);
    Seal(bytes);
    EXPECT_EQ(DecodeOpenIgtLink(bytes, kPeer).status, DecodeStatus::kRefused) << size;
  }
}

TEST(DamagedOpenIgtLink, GarbageNeverGivesAMessage) {
  std::mt19937_64 rng(3);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes(rng() % 300);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(rng());
    if (bytes.size() > 2 && i % 2 == 0) Put(bytes, 0, 1 + i % 3, 2);
    EXPECT_TRUE(DecodeOpenIgtLink(bytes, kPeer).messages.empty());
  }
}

TEST(DamagedOpenIgtLink, LinesHoldNoControlCharacters) {
  Bytes bytes = Samples()[0];
  bytes[14] = '\n';
  bytes[15] = '\x1b';
  bytes.back() ^= 1;
  const Decoded decoded = DecodeOpenIgtLink(bytes, kPeer);
  ASSERT_EQ(decoded.status, DecodeStatus::kRefused);
  for (const char c : decoded.why) EXPECT_GE(c, ' ');
}

}  // namespace
}  // namespace flextip::live
