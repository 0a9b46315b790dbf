// flextip batch over the ranks of an Open MPI job.
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "tests/apps/batch/batch_fixture.h"

namespace flextip::batch_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

#if FLEXTIP_MPI
class BatchRanks : public BatchCommand {
 protected:
  void SetUp() override {
    list_ = folder_.Write(
        "list.txt", Sample(0) + "\n" + Sample(1) + "\n" + Sample(2) + " name=third\nabsent\n");
    RunProgram({"batch", "check", list_, "-o", Out("whole"), "--jobs", "1"});
  }
  ProgramResult Mpirun(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> line{"--allow-run-as-root",
                                  "--oversubscribe",
                                  "-n",
                                  "3",
                                  FLEXTIP_PROGRAM,
                                  "batch",
                                  "check",
                                  list_,
                                  "-o",
                                  Out(out)};
    line.insert(line.end(), more.begin(), more.end());
    return RunProgram(line, FLEXTIP_MPIRUN);
  }
  void ExpectAsAlone(const std::string& out) const {
    EXPECT_EQ(TableWithoutTimes(folder_ / out), TableWithoutTimes(folder_ / "whole"));
    EXPECT_EQ(FilesBelow(folder_ / (out + "/items")), FilesBelow(folder_ / "whole/items"));
    EXPECT_EQ(FilesBelow(folder_ / (out + "/logs")), FilesBelow(folder_ / "whole/logs"));
  }
  std::string list_;
};

TEST_F(BatchRanks, WriteTheSameBytes) {
  const ProgramResult run = Mpirun("out");
  EXPECT_THAT(run.err, HasSubstr("1 of 4 items failed: "));
  ExpectAsAlone("out");
}

TEST_F(BatchRanks, SendResultsWhereNoFilesAreShared) {
  const ProgramResult run = Mpirun("out", {"--no-shared-files"});
  EXPECT_THAT(run.err, HasSubstr("1 of 4 items failed: "));
  ExpectAsAlone("out");
}

TEST_F(BatchRanks, GoOnAfterAnInterruption) {
  RunProgram({"batch", "check", list_, "-o", Out(), "--jobs", "1"});
  fs::resize_file(folder_ / "out/records.tsv", fs::file_size(folder_ / "out/records.tsv") / 2);
  const ProgramResult run = Mpirun("out", {"--resume"});
  EXPECT_THAT(run.out, HasSubstr("of 4 were done before"));
  ExpectAsAlone("out");
}

TEST_F(BatchRanks, SayOnceWhatIsWrong) {
  EXPECT_THAT(Mpirun("whole").err, HasSubstr("whole: exists and is not empty"));
}
#else
TEST(BatchRanks, AreRefusedWithoutMpi) {
  const TestFolder folder;
  setenv("OMPI_COMM_WORLD_RANK", "0", 1);
  const ProgramResult run =
      RunProgram({"batch", "check", Sample(0) + "*", "-o", (folder / "out").string()});
  unsetenv("OMPI_COMM_WORLD_RANK");
  EXPECT_TRUE(IsRefused(run, {"built without MPI"}));
}
#endif

}  // namespace
}  // namespace flextip::batch_test
