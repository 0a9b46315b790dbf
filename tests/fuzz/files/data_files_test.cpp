// The kept inputs of the readers of recordings and of what is imported: where foreign data arrives.
#include "tests/fuzz/corpus_files.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

TEST(DataFileCorpus, BreaksNoPromiseOfRecordings) {
  CheckCorpus("recording", CheckRecordingInput, 15, 13);
}
TEST(DataFileCorpus, BreaksNoPromiseOfArms) { CheckCorpus("arm", CheckArmInput, 6, 3); }
TEST(DataFileCorpus, BreaksNoPromiseOfTables) { CheckCorpus("csv", CheckCsvInput, 5, 3); }
TEST(DataFileCorpus, BreaksNoPromiseOfCalibrations) {
  CheckCorpus("calibration", CheckCalibrationInput, 3, 2);
}
TEST(DataFileCorpus, BreaksNoPromiseOfCameras) { CheckCorpus("camera", CheckCameraInput, 6, 4); }
TEST(DataFileCorpus, BreaksNoPromiseOfImports) { CheckCorpus("import", CheckImportInput, 5, 4); }
TEST(DataFileCorpus, BreaksNoPromiseOfMcapBags) { CheckCorpus("mcap", CheckMcapInput, 6, 4); }
// Understood where the program is built with what reads them.
TEST(DataFileCorpus, BreaksNoPromiseOfRosBags) { CheckCorpus("rosbag", CheckRosBagInput, 1, 0); }
TEST(DataFileCorpus, BreaksNoPromiseOfImages) { CheckCorpus("image", CheckImageInput, 6, 5); }
TEST(DataFileCorpus, BreaksNoPromiseOfVideos) { CheckCorpus("video", CheckVideoInput, 3, 2); }
TEST(DataFileCorpus, BreaksNoPromiseOfSideCars) { CheckCorpus("sidecar", CheckSideCarInput, 4, 3); }

}  // namespace
}  // namespace flextip
