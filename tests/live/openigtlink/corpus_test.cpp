// The kept inputs of the fuzzing program, as a test of every build.
#include <gtest/gtest.h>

#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/openigtlink_input.h"

namespace flextip {
namespace {

TEST(OpenIgtLinkCorpus, BreaksNoPromiseOfTheCodec) {
  const auto files = CorpusFiles("openigtlink");
  int messages = 0;
  for (const auto& bytes : files) messages += CheckOpenIgtLinkInput(bytes);
  EXPECT_GE(files.size(), 20u);
  EXPECT_GE(messages, 10);
}

}  // namespace
}  // namespace flextip
