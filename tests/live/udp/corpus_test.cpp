// The kept inputs of the fuzzing program, as a test of every build.
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/udp_input.h"

namespace flextip {
namespace {

TEST(UdpCorpus, BreaksNoPromiseOfTheReader) { CheckCorpus("udp", CheckUdpInput, 20, 10); }

}  // namespace
}  // namespace flextip
