#include "batch/line_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "core/error.h"
#include "tests/batch/work_of_tests.h"

namespace flextip::batch {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::string Bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(LineFile, KeepsWholeLinesAndCutsATornOne) {
  const BatchTestFolder folder;
  std::ofstream(folder / "lines") << "one\ntwo\nthr";
  EXPECT_THAT(WholeLines(folder / "lines"), ElementsAre("one", "two"));
  LineFile(folder / "lines").Append({"three", "four"});
  EXPECT_EQ(Bytes(folder / "lines"), "one\ntwo\nthree\nfour\n");
}

TEST(LineFile, IsMadeWhereThereIsNone) {
  const BatchTestFolder folder;
  EXPECT_THAT(WholeLines(folder / "lines"), IsEmpty());
  LineFile(folder / "lines").Append({"one"});
  EXPECT_THAT(WholeLines(folder / "lines"), ElementsAre("one"));
  EXPECT_THROW(LineFile(folder / "absent" / "lines"), WorkError);
}

TEST(LineFile, CutsAFileOfOneTornLineToNothing) {
  const BatchTestFolder folder;
  std::ofstream(folder / "lines") << "torn";
  LineFile(folder / "lines").Append({"one"});
  EXPECT_EQ(Bytes(folder / "lines"), "one\n");
}

/// The disk is full: what was written of the line goes, and later lines find their place.
TEST(LineFile, LeavesNoTornLineOnAFullDisk) {
  const BatchTestFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{10, RLIM_INFINITY};
    LineFile file(folder / "lines");
    file.Append({"one"});
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      file.Append({"a line too long for the disk"});
    } catch (const WorkError& error) {
      const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
      setrlimit(RLIMIT_FSIZE, &none);
      if (std::string(error.what()).find("cannot be written") == std::string::npos) _exit(2);
      file.Append({"two"});
      _exit(0);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(Bytes(folder / "lines"), "one\ntwo\n");
}

}  // namespace
}  // namespace flextip::batch
