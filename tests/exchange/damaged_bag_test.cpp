// Bags with one wrong byte: they are read, or refused in one line.
#include <gmock/gmock.h>

#include <filesystem>

#include "exchange/bags/bags.h"
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

}  // namespace
}  // namespace flextip::exchange
