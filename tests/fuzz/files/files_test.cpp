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
TEST(FileCorpus, BreaksNoPromiseOfMaps) { CheckCorpus("map", CheckMapInput, 4, 3); }
TEST(FileCorpus, BreaksNoPromiseOfMeshes) { CheckCorpus("mesh", CheckMeshInput, 3, 1); }
TEST(FileCorpus, BreaksNoPromiseOfMcapBags) { CheckCorpus("mcap", CheckMcapInput, 6, 4); }
// Understood where the program is built with what reads them.
TEST(FileCorpus, BreaksNoPromiseOfRosBags) { CheckCorpus("rosbag", CheckRosBagInput, 1, 0); }
TEST(FileCorpus, BreaksNoPromiseOfImages) { CheckCorpus("image", CheckImageInput, 6, 5); }
TEST(FileCorpus, BreaksNoPromiseOfVideos) { CheckCorpus("video", CheckVideoInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfSideCars) { CheckCorpus("sidecar", CheckSideCarInput, 4, 3); }
TEST(FileCorpus, BreaksNoPromiseOfResultTables) { CheckCorpus("table", CheckTableInput, 3, 2); }
TEST(FileCorpus, BreaksNoPromiseOfResults) { CheckCorpus("result", CheckResultInput, 3, 3); }

}  // namespace
}  // namespace flextip
