// The kept inputs of the fuzzing program, as a test of every build.
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/ros2_input.h"

namespace flextip {
namespace {

TEST(Ros2Corpus, BreaksNoPromiseOfTheMessages) { CheckCorpus("ros2", CheckRos2Input, 20, 10); }

}  // namespace
}  // namespace flextip
