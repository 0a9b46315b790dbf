// Commands that are killed, that find the disk full, and that run twice at once: what looks whole
// is whole. bench/robustness/kills.py does the same a thousand times, with every command.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <random>
#include <set>
#include <thread>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

const std::string kData = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/";

/// Commands of some tenths of a second each.
const std::vector<std::vector<std::string>> kCommands{
    {"check", kData + "recordings/sample_0"},
    {"estimate", kData + "recordings/sample_0"},
    {"export", "tum", kData + "recordings/sample_0"}};

class Disturbed : public testing::Test {
 protected:
  std::vector<std::string> Line(std::vector<std::string> command, bool force = false) const {
    command.insert(command.end(), {"-o", (folder_ / "work/out").string(), "--quiet"});
    if (force) command.emplace_back("--force");
    return command;
  }
  pid_t Begin(const std::vector<std::string>& arguments, rlim_t most_bytes = RLIM_INFINITY) const {
    const pid_t child = fork();
    if (child != 0) return child;
    if (most_bytes != RLIM_INFINITY) {  // as a full disk: a write fails
      signal(SIGXFSZ, SIG_IGN);
      const rlimit size{most_bytes, most_bytes};
      setrlimit(RLIMIT_FSIZE, &size);
    }
    std::vector<std::string> copies(arguments);
    std::string program = FLEXTIP_PROGRAM;
    std::vector<char*> argv{program.data()};
    for (auto& argument : copies) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, STDOUT_FILENO);
    dup2(nothing, STDERR_FILENO);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  static int End(pid_t process) {
    int status = 0;
    waitpid(process, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  void Clear() const {
    fs::remove_all(folder_ / "work");
    fs::create_directories(folder_ / "work");
  }
  std::set<std::string> Result() const {
    std::set<std::string> names;
    if (!fs::exists(folder_ / "work/out")) return names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "work/out")) {
      EXPECT_TRUE(entry.is_directory() || fs::file_size(entry.path()) > 0) << entry.path();
      names.insert(fs::relative(entry.path(), folder_ / "work/out").string());
    }
    return names;
  }
  /// What stands beside the result.
  std::size_t Beside() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "work"))
      count += entry.path().filename() != "out" ? 1 : 0;
    return count;
  }

  TestFolder folder_;
};

TEST_F(Disturbed, AKilledCommandLeavesAWholeResultOrNone) {
  std::mt19937 generator(3);
  for (const auto& command : kCommands) {
    Clear();
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(End(Begin(Line(command))), 0) << command[0];
    const std::chrono::duration<double> whole_s = std::chrono::steady_clock::now() - begin;
    const auto whole = Result();
    ASSERT_FALSE(whole.empty());
    for (int turn = 0; turn < 6; ++turn) {
      const bool force = turn % 2 == 1;  // in place of the result that is there
      if (!force) Clear();
      if (force && !fs::exists(folder_ / "work/out")) {
        ASSERT_EQ(End(Begin(Line(command))), 0);
      }
      const pid_t process = Begin(Line(command, force));
      std::this_thread::sleep_for(whole_s *
                                  std::uniform_real_distribution<double>(0.0, 1.0)(generator));
      kill(process, SIGKILL);
      End(process);
      const auto result = Result();
      EXPECT_TRUE(result == whole || (result.empty() && !force)) << command[0] << " " << turn;
    }
  }
}

TEST_F(Disturbed, AFullDiskLeavesNothing) {
  for (const auto& command : kCommands) {
    for (const rlim_t bytes : {0, 300, 5000}) {
      Clear();
      const int code = End(Begin(Line(command), bytes));
      EXPECT_TRUE(code == 1 || code == 2) << command[0] << " " << bytes << ": " << code;
      EXPECT_FALSE(fs::exists(folder_ / "work/out")) << command[0] << " " << bytes;
      EXPECT_EQ(Beside(), 0u) << command[0] << " " << bytes;
    }
  }
}

TEST_F(Disturbed, TwoAtOnceMakeOneResult) {
  for (const auto& command : kCommands) {
    for (const bool force : {false, true}) {
      Clear();
      if (force) {
        ASSERT_EQ(End(Begin(Line(command))), 0);
      }
      const pid_t first = Begin(Line(command, force)), second = Begin(Line(command, force));
      const int codes[] = {End(first), End(second)};
      EXPECT_TRUE(codes[0] == 0 || codes[1] == 0) << command[0];
      if (force) {
        EXPECT_EQ(codes[0] + codes[1], 0) << command[0];
      }
      EXPECT_FALSE(Result().empty()) << command[0];
      EXPECT_EQ(Beside(), 0u) << command[0];
    }
  }
}

TEST_F(Disturbed, AWriteProtectedFolderIsSaid) {
  if (geteuid() == 0) GTEST_SKIP() << "root writes anywhere";
  Clear();
  fs::permissions(folder_ / "work", fs::perms::owner_read | fs::perms::owner_exec);
  const auto result = RunProgram(Line(kCommands[0]));
  fs::permissions(folder_ / "work", fs::perms::owner_all);
  EXPECT_TRUE(IsRefused(result, {"out", "ermission"}));
}

}  // namespace
}  // namespace flextip
