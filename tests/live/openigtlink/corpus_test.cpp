// The kept inputs of the fuzzing program, as a test of every build.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/openigtlink_input.h"

namespace flextip {
namespace {

TEST(OpenIgtLinkCorpus, BreaksNoPromiseOfTheCodec) {
  const std::filesystem::path folder =
      std::filesystem::path(FLEXTIP_SOURCE_DIR) / "tests/fuzz/corpus/openigtlink";
  int files = 0, messages = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    messages += CheckOpenIgtLinkInput(bytes);
    ++files;
  }
  EXPECT_GE(files, 20);
  EXPECT_GE(messages, 10);
}

}  // namespace
}  // namespace flextip
