// The kept inputs of the fuzzing program, as a test of every build.
#include <gtest/gtest.h>

#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/ros2_input.h"

namespace flextip {
namespace {

TEST(Ros2Corpus, BreaksNoPromiseOfTheMessages) {
  const auto files = CorpusFiles("ros2");
  int messages = 0;
  for (const auto& bytes : files) messages += CheckRos2Input(bytes);
  EXPECT_GE(files.size(), 20u);
  EXPECT_GE(messages, 10);
}

}  // namespace
}  // namespace flextip
