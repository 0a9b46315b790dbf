// Bags with one wrong byte: they are read, or refused in one line.
#include <gmock/gmock.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "exchange/bags/bags.h"
#include "exchange/bags/pictures.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::ReadText;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;

class DamagedBag : public testing::TestWithParam<const char*> {};

// The library that reads bags of ROS 1 asked for gigabytes, and read beyond its memory.
TEST_P(DamagedBag, IsReadOrRefused) {
  const TemporaryFolder folder;
  const auto kept = std::filesystem::path(FLEXTIP_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam();
  const std::string whole = ReadText(kept);
  const auto read = [&](const std::string& text) {
    WriteText(folder / "a.bag", text);
    long messages = 0;
    const Bags bags({folder / "a.bag"});
    std::map<std::string, Bags::Take> takes;
    for (const auto& topic : bags.Topics())
      takes[topic.name] = [&](const BagMessage&, long) { ++messages; };
    bags.Read(takes);
    return messages;
  };
  try {
    ASSERT_GT(read(whole), 0);
  } catch (const InputError& error) {
    ASSERT_THAT(error.what(), testing::HasSubstr("was built without"));
    GTEST_SKIP() << error.what();
  }
  int refused = 0;
  for (std::size_t at = 13; at < whole.size(); ++at) {
    if (whole[at] == ' ') continue;  // the bag header's padding
    std::string text = whole;
    text[at] = '\xff';
    try {
      read(text);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedBag, testing::Values("rosbag/poses", "mcap/tool"),
                         [](const auto& kind) {
                           const std::string name = kind.param;
                           return name.substr(0, name.find('/'));
                         });

// OpenCV threw, or took what is no colour for one.
TEST(PictureOfABag, IsRefusedWithoutPixelsAndWhereNoColoursCanBeMade) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> data(64, 7);
  struct Case {
    int width_px, height_px;
    const char* encoding;
    std::size_t step;
  };
  for (const Case& c : {Case{4, 0, "mono8", 4}, Case{4, -1, "mono8", 0}, Case{-4, 2, "mono8", 4},
                        Case{3, 2, "yuv422", 6}, Case{3, 2, "yuyv", 6}}) {
    const ImageMessage message{.width_px = c.width_px,
                               .height_px = c.height_px,
                               .encoding = c.encoding,
                               .step = c.step,
                               .data = data};
    try {
      WritePicture(folder / "1.png", message);
      ADD_FAILURE() << c.width_px << " x " << c.height_px << " " << c.encoding;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("1.png: found "));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("OpenCV")));
    }
  }
  for (const char* encoding : {"mono8", "bayer_rggb8", "yuyv"}) {
    WritePicture(folder / "2.png",
                 {.width_px = 2, .height_px = 2, .encoding = encoding, .step = 4, .data = data});
    EXPECT_GT(std::filesystem::file_size(folder / "2.png"), 0U) << encoding;
  }
}

}  // namespace
}  // namespace flextip::exchange
