// flextip diagnose of several recordings over the ranks of an Open MPI job.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "testdata/hidden/recording.h"
#include "tests/apps/batch/batch_fixture.h"

namespace flextip::batch_test {
namespace {

using testing::HasSubstr;

#if FLEXTIP_MPI
class DiagnoseRanks : public BatchCommand {
 protected:
  std::vector<std::string> Command(const std::vector<std::string>& recordings,
                                   const std::string& out) const {
    std::vector<std::string> line{"diagnose", "--no-closed-loop", "-o", Out(out)};
    line.insert(line.end(), recordings.begin(), recordings.end());
    return line;
  }
  ProgramResult Mpirun(const std::vector<std::string>& command) const {
    std::vector<std::string> line{"--allow-run-as-root", "--oversubscribe", "-n", "3",
                                  FLEXTIP_PROGRAM};
    line.insert(line.end(), command.begin(), command.end());
    return RunProgram(line, FLEXTIP_MPIRUN);
  }
  /// But for the page and the summary, which name the command and the date.
  std::map<std::string, std::string> Results(const std::string& out) const {
    auto files = FilesBelow(folder_ / out);
    files.erase("report.html");
    files.erase("summary.json");
    return files;
  }
};

TEST_F(DiagnoseRanks, WriteTheSameBytes) {
  hidden::HiddenSeries series{.recordings = 4, .later = {"stiffness"}, .begin = 2};
  series.options.scene.duration_s = 6.0;
  std::vector<std::string> recordings;
  for (const auto& one : hidden::MakeHiddenSeries(series, 44)) {
    recordings.push_back(Out("day_" + std::to_string(recordings.size())));
    hidden::WriteHidden(recordings.back(), one);
  }
  EXPECT_EQ(RunProgram(Command(recordings, "alone")).exit_code, 0);
  const ProgramResult run = Mpirun(Command(recordings, "ranks"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("In all 4 recordings"));
  EXPECT_GE(Results("alone").size(), 4 * 2 + 2);
  EXPECT_EQ(Results("ranks"), Results("alone"));
}

TEST_F(DiagnoseRanks, SayOnceWhatIsWrong) {
  const ProgramResult run = Mpirun(Command({Sample(0), "absent"}, "out"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("absent: no such folder"));
  EXPECT_EQ(run.err.find("absent: no such"), run.err.rfind("absent: no such"));
}
#else
TEST(DiagnoseRanks, AreRefusedWithoutMpi) {
  setenv("OMPI_COMM_WORLD_RANK", "0", 1);
  setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
  const TestFolder folder;
  const ProgramResult run = RunProgram({"diagnose", Sample(0), "-o", (folder / "out").string()});
  unsetenv("OMPI_COMM_WORLD_RANK");
  unsetenv("OMPI_COMM_WORLD_SIZE");
  EXPECT_TRUE(IsRefused(run, {"built without MPI"}));
}
#endif

}  // namespace
}  // namespace flextip::batch_test
