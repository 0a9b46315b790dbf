// The kept inputs of the fuzzing program, as a test of every build.
#include <gtest/gtest.h>

#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/udp_input.h"

namespace flextip {
namespace {

TEST(UdpCorpus, BreaksNoPromiseOfTheReader) {
  const auto files = CorpusFiles("udp");
  int poses = 0;
  for (const auto& bytes : files) poses += CheckUdpInput(bytes);
  EXPECT_GE(files.size(), 20u);
  EXPECT_GE(poses, 10);
}

}  // namespace
}  // namespace flextip
