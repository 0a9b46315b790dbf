// The kept inputs of the readers of files that are not in data_files_test.cpp.
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

TEST(FileCorpus, BreaksNoPromiseOfScenarios) { CheckCorpus("scenario", CheckScenarioInput, 5, 3); }
TEST(FileCorpus, BreaksNoPromiseOfSessions) { CheckCorpus("session", CheckSessionInput, 4, 1); }
TEST(FileCorpus, BreaksNoPromiseOfModels) { CheckCorpus("model", CheckModelInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfArmModels) { CheckCorpus("armmodel", CheckArmModelInput, 3, 1); }
TEST(FileCorpus, BreaksNoPromiseOfCorners) { CheckCorpus("corners", CheckCornersInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfMaps) { CheckCorpus("map", CheckMapInput, 4, 3); }
TEST(FileCorpus, BreaksNoPromiseOfMeshes) { CheckCorpus("mesh", CheckMeshInput, 3, 1); }
TEST(FileCorpus, BreaksNoPromiseOfResultTables) { CheckCorpus("table", CheckTableInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfResults) { CheckCorpus("result", CheckResultInput, 3, 3); }

}  // namespace
}  // namespace flextip
