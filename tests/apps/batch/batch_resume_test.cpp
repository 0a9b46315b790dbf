// flextip batch, interrupted: nothing lost, nothing twice, the table as if nothing had happened.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include "tests/apps/batch/batch_fixture.h"

namespace flextip::batch_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

class BatchResume : public BatchCommand {
 protected:
  /// Eight checks and a failure.
  void SetUp() override {
    std::string text = "absent\n";
    for (int i = 0; i < 8; ++i) {
      text += fmt::format("{} name=item{} --no-pictures\n", Sample(i % 4), i);
    }
    list_ = folder_.Write("list.txt", text);
  }
  std::vector<std::string> Line(const std::string& out, bool resume = true) const {
    std::vector<std::string> line{"batch", "check", list_, "-o", Out(out), "--jobs", "2"};
    if (resume) line.emplace_back("--resume");
    return line;
  }
  void ExpectAsUndisturbed(const std::string& out) const {
    EXPECT_EQ(TableWithoutTimes(folder_ / out), TableWithoutTimes(folder_ / "whole"));
    EXPECT_EQ(FilesBelow(folder_ / (out + "/items")), FilesBelow(folder_ / "whole/items"));
    EXPECT_EQ(FilesBelow(folder_ / (out + "/logs")), FilesBelow(folder_ / "whole/logs"));
  }
  /// Waits for a condition, 10 s at most.
  static void WaitFor(const std::function<bool()>& condition) {
    const auto end = Clock::now() + std::chrono::seconds(10);
    while (!condition() && Clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  int Records(const std::string& out) const {
    const std::string text = ReadText(folder_ / (out + "/records.tsv"));
    return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  }
  std::string list_;
};

TEST_F(BatchResume, SaysHowManyWereDoneAndDoesNothingTwice) {
  ASSERT_EQ(RunProgram(Line("whole", false)).exit_code, 1);
  const auto written = fs::last_write_time(folder_ / "whole/items/item0/summary.json");
  const ProgramResult again = RunProgram(Line("whole"));
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.out, HasSubstr("9 of 9 were done before"));
  EXPECT_EQ(fs::last_write_time(folder_ / "whole/items/item0/summary.json"), written);
  EXPECT_EQ(Records("whole"), 9);
}

TEST_F(BatchResume, AfterTwentyKills) {
  const auto begin = Clock::now();
  ASSERT_EQ(RunProgram(Line("whole")).exit_code, 1);
  const double whole_s = std::chrono::duration<double>(Clock::now() - begin).count();
  std::mt19937 random(17);
  std::uniform_real_distribution<double> share(0.02, 0.6);
  int killed = 0, most_done = 0, runs = 0;
  while (killed < 20 && runs < 60) {
    ++runs;
    const pid_t batch = Begin(Line("out"), folder_ / "");
    if (runs % 2 == 0) {  // after some items, however slow the machine is
      const int some = 1 + static_cast<int>(random() % 6);
      WaitFor([&] { return fs::exists(folder_ / "out/records.tsv") && Records("out") >= some; });
    } else {
      std::this_thread::sleep_for(std::chrono::duration<double>(share(random) * whole_s));
    }
    const auto starters = Below(batch, "flextip-items");
    const bool starter = killed % 3 == 2 && !starters.empty();
    kill(starter ? starters[0] : batch, SIGKILL);
    const int code = ExitCodeOf(batch);
    if (starter ? code == 1 : code == 128 + SIGKILL) ++killed;
    const int done = fs::exists(folder_ / "out/records.tsv") ? Records("out") : 0;
    most_done = std::max(most_done, done);
    if (done == 9) {  // all are done: begin anew
      ExpectAsUndisturbed(RunProgram(Line("out")).exit_code == 1 ? "out" : "");
      fs::remove_all(folder_ / "out");
    }
  }
  EXPECT_EQ(killed, 20);
  EXPECT_GT(most_done, 0);
  ASSERT_EQ(RunProgram(Line("out")).exit_code, 1);
  EXPECT_EQ(Records("out"), 9);
  ExpectAsUndisturbed("out");
}

TEST_F(BatchResume, DoesTornRecordsAndResultsAgain) {
  ASSERT_EQ(RunProgram(Line("whole")).exit_code, 1);
  fs::copy(folder_ / "whole", folder_ / "out", fs::copy_options::recursive);
  fs::resize_file(folder_ / "out/records.tsv", fs::file_size(folder_ / "out/records.tsv") - 3);
  fs::remove_all(folder_ / "out/items/item3");
  folder_.Write("out/items/item4.partial-12/half", "half");
  const ProgramResult again = RunProgram(Line("out"));
  EXPECT_TRUE(again.out.find("7 of 9 were done before") != std::string::npos ||
              again.out.find("8 of 9 were done before") != std::string::npos)
      << again.out;  // item3 may be the torn one
  EXPECT_EQ(Records("out"), 9);
  ExpectAsUndisturbed("out");
}

TEST_F(BatchResume, StopsOnAFullDiskAndGoesOn) {
  ASSERT_EQ(RunProgram(Line("whole")).exit_code, 1);
  const pid_t batch = fork();
  if (batch == 0) {  // files may not become as large as a page
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{6'000, 6'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    _exit(ExitCodeOf(Begin(Line("out"), folder_ / "")));
  }
  EXPECT_EQ(ExitCodeOf(batch), 1);
  EXPECT_THAT(ReadText(folder_ / "stderr"), HasSubstr("the disk takes no more"));
  EXPECT_LE(Records("out"), 1);  // that of `absent`, which writes nothing
  EXPECT_EQ(RunProgram(Line("out")).exit_code, 1);
  ExpectAsUndisturbed("out");
}

TEST_F(BatchResume, LetsOneProgramIn) {
  const std::string list = folder_.Write("slow.txt", Sample(2) + "\n" + Sample(3) + "\n");
  const std::vector<std::string> line{"batch", "diagnose", list, "-o", Out(), "--resume"};
  const pid_t batch = Begin(line, folder_ / "");
  while (!fs::exists(folder_ / "out/records.tsv")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(batch, SIGSTOP);
  EXPECT_TRUE(IsRefused(RunProgram(line), {"out: another program is at work on it"}));
  kill(batch, SIGCONT);
  kill(batch, SIGINT);
  EXPECT_EQ(ExitCodeOf(batch), 128 + SIGINT);
  EXPECT_THAT(ReadText(folder_ / "stderr"), HasSubstr("--resume goes on"));
}

TEST_F(BatchResume, RefusesAnotherBatch) {
  ASSERT_EQ(RunProgram(Line("out")).exit_code, 1);
  std::vector<std::string> line = Line("out");
  line[1] = "estimate";
  EXPECT_TRUE(IsRefused(RunProgram(line), {"batch.json: is a batch of check, expected estimate"}));
  line = Line("out");
  line.insert(line.end(), {"--", "--json"});
  EXPECT_TRUE(IsRefused(RunProgram(line), {"batch.json: has the options '', expected '--json'"}));
  folder_.Write("list.txt", Sample(0) + "\n");
  EXPECT_TRUE(IsRefused(RunProgram(Line("out")), {"has an item absent that the list has not"}));
}

TEST_F(BatchResume, TakesAListThatHasBecomeLonger) {
  ASSERT_EQ(RunProgram(Line("out")).exit_code, 1);
  std::ofstream(list_, std::ios::app) << Sample(5) << "\n";
  EXPECT_THAT(RunProgram(Line("out")).out, HasSubstr("9 of 10 were done before"));
  EXPECT_EQ(RowOf(folder_ / "out", "sample_5").at("status"), "ok");
}

TEST_F(BatchResume, RefusesDamagedRecordsWithTheirLine) {
  ASSERT_EQ(RunProgram(Line("out")).exit_code, 1);
  std::ofstream(folder_ / "out/records.tsv", std::ios::app) << "no record\n";
  EXPECT_TRUE(IsRefused(RunProgram(Line("out")), {"records.tsv:10: "}));
}

}  // namespace
}  // namespace flextip::batch_test
