// The kept inputs of the fuzzing program of watchers' texts, as a test of every build.
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/page_input.h"

namespace flextip {
namespace {

TEST(PageCorpus, BreaksNoPromiseOfTheReader) { CheckCorpus("page", CheckPageInput, 20, 6); }

}  // namespace
}  // namespace flextip
