// The kept inputs of the fuzzing programs, as a test of every build.
#include "tests/fuzz/connection_input.h"
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/openigtlink_input.h"

namespace flextip {
namespace {

TEST(OpenIgtLinkCorpus, BreaksNoPromiseOfTheCodec) {
  CheckCorpus("openigtlink", CheckOpenIgtLinkInput, 20, 10);
}

TEST(ConnectionCorpus, ArrivesTheSameHoweverItIsCut) {
  CheckCorpus("connection", CheckConnectionInput, 15, 20);
}

}  // namespace
}  // namespace flextip
