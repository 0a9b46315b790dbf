// The kept inputs of the readers of files.
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

TEST(FileCorpus, BreaksNoPromiseOfRecordings) {
  CheckCorpus("recording", CheckRecordingInput, 10, 8);
}
TEST(FileCorpus, BreaksNoPromiseOfTables) { CheckCorpus("csv", CheckCsvInput, 5, 3); }
TEST(FileCorpus, BreaksNoPromiseOfScenarios) { CheckCorpus("scenario", CheckScenarioInput, 5, 3); }
TEST(FileCorpus, BreaksNoPromiseOfSessions) { CheckCorpus("session", CheckSessionInput, 4, 1); }
TEST(FileCorpus, BreaksNoPromiseOfModels) { CheckCorpus("model", CheckModelInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfCalibrations) {
  CheckCorpus("calibration", CheckCalibrationInput, 3, 2);
}
TEST(FileCorpus, BreaksNoPromiseOfCameras) { CheckCorpus("camera", CheckCameraInput, 6, 4); }
TEST(FileCorpus, BreaksNoPromiseOfCorners) { CheckCorpus("corners", CheckCornersInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfImports) { CheckCorpus("import", CheckImportInput, 5, 4); }

}  // namespace
}  // namespace flextip
