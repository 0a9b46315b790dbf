// Serialised messages byte by byte, as the two encodings are defined.
#include "exchange/bags/wire.h"

#include <gmock/gmock.h>

#include "exchange/bags/messages.h"

namespace flextip::exchange {
namespace {

using testing::ElementsAre;

using Buffer = std::vector<std::uint8_t>;

TEST(Wire, Ros1IsPacked) {
  const Buffer bytes{3, 0, 0, 0, 'a', 'b', 'c', 7, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F};
  WireReader wire(bytes, WireFormat::kRos1);
  EXPECT_EQ(wire.Text(), "abc");
  EXPECT_EQ(wire.U8(), 7);
  EXPECT_EQ(wire.F64(), 1.0);
  EXPECT_THROW(wire.U8(), WireError);
}

TEST(Wire, CdrAlignsFromBehindItsHead) {
  // A text of two letters and its zero end at byte 7; the double stands at byte 8.
  const Buffer little{0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0, 99, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F};
  WireReader wire(little, WireFormat::kCdr);
  EXPECT_EQ(wire.Text(), "ab");
  EXPECT_EQ(wire.F64(), 1.0);
  // Four bytes of nothing stand between a big-endian 2 and the double.
  const Buffer big{0, 0, 0, 0, 0, 0, 0, 2, 99, 99, 99, 99, 0xC0, 0, 0, 0, 0, 0, 0, 0};
  WireReader other(big, WireFormat::kCdr);
  EXPECT_EQ(other.U32(), 2U);
  EXPECT_EQ(other.F64(), -2.0);
}

TEST(Wire, CountsBeyondTheMessageAreRefused) {
  const Buffer bytes{0xFF, 0xFF, 0xFF, 0xFF, 1, 2};
  EXPECT_THROW(WireReader(bytes, WireFormat::kRos1).Text(), WireError);
  EXPECT_THROW(WireReader(bytes, WireFormat::kRos1).F64s(), WireError);
  EXPECT_THROW(WireReader(bytes, WireFormat::kRos1).U8s(), WireError);
  EXPECT_THROW(WireReader(bytes, WireFormat::kRos1).Texts(), WireError);
  EXPECT_THROW(WireReader(Buffer{0, 7, 0, 0}, WireFormat::kCdr), WireError);
}

TEST(Wire, AWrenchOfRos1) {
  Buffer bytes{9, 0, 0, 0, 5, 0, 0, 0, 250, 0, 0, 0, 1, 0, 0, 0, 'f'};
  for (const std::uint8_t high : Buffer{0x3F, 0xBF, 0x40, 0, 0, 0}) {
    bytes.insert(bytes.end(), {0, 0, 0, 0, 0, 0, 0, high});
  }
  const NumbersMessage message = ReadWrenchStamped(WireReader(bytes, WireFormat::kRos1));
  EXPECT_EQ(message.header.stamp_ns, 5'000'000'250);
  EXPECT_EQ(message.header.frame, "f");
  EXPECT_THAT(message.values, ElementsAre(0x1p-15, -0x1p-15, 2.0));
}

}  // namespace
}  // namespace flextip::exchange
