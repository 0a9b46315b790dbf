// flextip batch: rows, items, the same bytes whatever the jobs.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/apps/batch/batch_fixture.h"

namespace flextip::batch_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(BatchCommand, WritesTheSameBytesWhateverTheJobs) {
  const std::string list = folder_.Write(
      "list.txt", Sample(0) + "\n" + Sample(1) + " name=other --without em0\nabsent\n");
  for (const char* jobs : {"1", "2"}) {
    const ProgramResult run =
        RunProgram({"batch", "estimate", list, "-o", Out(jobs), "--jobs", jobs});
    EXPECT_EQ(run.exit_code, 1) << run.err;  // one is absent
    EXPECT_THAT(run.err, HasSubstr("of 3 items failed: "));
  }
  const auto one = FilesBelow(folder_ / "1/items");
  EXPECT_TRUE(one.contains("sample_0/state0/data.csv"));
  EXPECT_TRUE(one.contains("other/report.html") || one.contains("sample_0/report.html"));
  EXPECT_EQ(one, FilesBelow(folder_ / "2/items"));
  EXPECT_EQ(TableWithoutTimes(folder_ / "1"), TableWithoutTimes(folder_ / "2"));
}

TEST_F(BatchCommand, WritesWhatTheCommandAloneWrites) {
  const std::string list = folder_.Write("list.txt", Sample(0) + "\n");
  ASSERT_EQ(RunProgram({"batch", "estimate", list, "-o", Out()}).exit_code, 0);
  ASSERT_EQ(RunProgram({"estimate", Sample(0), "-o", Out("alone")}).exit_code, 0);
  auto item = FilesBelow(folder_ / "out/items/sample_0"), alone = FilesBelow(folder_ / "alone");
  auto summary = nlohmann::ordered_json::parse(alone["summary.json"]);
  summary.erase("seconds");
  summary.erase("date");
  summary["typed"] = "flextip estimate " + Sample(0) + " -o items/sample_0";
  summary["output"] = "items/sample_0";
  const auto said = nlohmann::ordered_json::parse(item["summary.json"]);
  summary["verdict"]["command"] = said["verdict"]["command"];  // has the path of the results
  EXPECT_EQ(said, summary);
  for (auto* files : {&item, &alone}) {  // the page has these
    files->erase("summary.json");
    EXPECT_EQ(files->erase("report.html"), 1U);
  }
  EXPECT_EQ(item, alone);
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out/items/sample_0"));
}

/// A folder stands for its pictures; two cameras are calibrated as one needs two of them.
TEST_F(BatchCommand, CalibratesCamerasByFoldersOfPictures) {
  const fs::path photos = "/usr/share/doc/opencv-doc/examples/data";
  if (!fs::exists(photos / "left01.jpg")) GTEST_SKIP() << "Debian's opencv-doc is not installed";
  for (const std::string eye : {"left", "right"}) {
    fs::create_directories(folder_ / eye);
    for (const int i : {1, 2, 3, 4, 5, 6, 7, 8}) {
      const std::string name = fmt::format("{}{:02}.jpg", eye, i);
      fs::create_symlink(photos / name, folder_ / eye / name);
    }
  }
  fs::create_directories(folder_ / "empty");
  const std::string list = folder_.Write("list.txt", "left\nright\nempty\n");
  const std::vector<std::string> board{"--", "--board", "chessboard:9x6:0.025"};
  std::vector<std::string> line{"batch", "calibrate", "camera", list, "-o", Out()};
  line.insert(line.end(), board.begin(), board.end());
  EXPECT_EQ(RunProgram(line).exit_code, 1);  // one folder is empty
  EXPECT_EQ(RowOf(folder_ / "out", "left").at("views_used"), "8");
  EXPECT_EQ(RowOf(folder_ / "out", "right").at("status"), "ok");
  EXPECT_THAT(RowOf(folder_ / "out", "empty").at("message"), HasSubstr("no PNG, JPEG or TIFF"));

  const std::string pairs = folder_.Write("pairs.txt", "left name=pair --right ./right\n");
  line = {"batch", "calibrate", "stereo", pairs, "-o", Out("stereo")};
  line.insert(line.end(), board.begin(), board.end());
  const ProgramResult run = RunProgram(line);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NEAR(std::stod(RowOf(folder_ / "stereo", "pair").at("baseline_m")), 0.083, 0.002);
}

/// A file elsewhere that cannot be written is the item's own trouble, not a full disk.
TEST_F(BatchCommand, GoesOnWhereAnItemCannotWriteElsewhere) {
  const fs::path photos = "/usr/share/doc/opencv-doc/examples/data";
  if (!fs::exists(photos / "left01.jpg")) GTEST_SKIP() << "Debian's opencv-doc is not installed";
  const std::string file = (photos / "left01.jpg").string();
  const std::string list = folder_.Write(
      "list.txt", file + " name=bad --corners /proc/none/corners\n" + file + " name=other\n");
  const ProgramResult run = RunProgram(
      {"batch", "calibrate", "camera", list, "-o", Out(), "--", "--board", "chessboard:9x6:0.025"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, Not(HasSubstr("the disk takes no more")));
  EXPECT_THAT(RowOf(folder_ / "out", "bad").at("message"), HasSubstr("cannot be written"));
  EXPECT_EQ(RowOf(folder_ / "out", "other").at("status"), "failed");  // a view is too few
}

/// `replay` of simulations, in processes of their own as all.
TEST_F(BatchCommand, ReplaysSimulations) {
  const std::string scenario = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml";
  ASSERT_EQ(RunProgram({"simulate", scenario, "-o", Out("press")}).exit_code, 0);
  const ProgramResult run =
      RunProgram({"batch", "replay", Out("press") + "/*-track/", "-o", Out()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"straight-track", "flex-track", "rod-track"}) {
    const auto row = RowOf(folder_ / "out", name);
    EXPECT_EQ(row.at("status"), "ok") << name;
    EXPECT_EQ(row.at("cycles"), row.at("equal_cycles")) << name;
    EXPECT_EQ(row.at("cycles"), "60") << name;
  }
}

TEST_F(BatchCommand, HasARowForEachItem) {
  ASSERT_EQ(
      RunProgram({"batch", "check", CheckList(), "-o", Out(), "--", "--no-pictures"}).exit_code, 1);
  const auto good = RowOf(folder_ / "out", "sample_0"), bad = RowOf(folder_ / "out", "absent");
  EXPECT_EQ(good.at("status"), "ok");
  EXPECT_EQ(good.at("exit_code"), "0");
  EXPECT_EQ(good.at("wrong"), "0");
  EXPECT_EQ(good.at("input"), Sample(0));
  EXPECT_EQ(bad.at("status"), "failed");
  EXPECT_EQ(bad.at("exit_code"), "2");
  EXPECT_THAT(bad.at("message"), HasSubstr("absent"));
  EXPECT_EQ(bad.at("wrong"), "");
  const std::string page = ReadText(folder_ / "out/report.html");
  EXPECT_THAT(page, HasSubstr("2 of 3 items of check ran through, 1 did not."));
  EXPECT_LT(page.find("Items that did not run through"), page.find(">sample_0</a>"));
  EXPECT_THAT(page, HasSubstr("href=\"items/sample_0/report.html\""));
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
}

TEST_F(BatchCommand, TakesAGlobAndGivesEachItemItsLine) {
  const std::string glob = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/recordings/sample_[01]";
  const ProgramResult run =
      RunProgram({"batch", "check", glob, "-o", Out(), "--jobs", "1", "--", "--no-pictures"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, AllOf(HasSubstr("flextip: 1 of 2, 0 failed: sample_"),
                             HasSubstr("flextip: 2 of 2, 0 failed: sample_")));
  EXPECT_EQ(RowOf(folder_ / "out", "sample_1").at("status"), "ok");
}

TEST_F(BatchCommand, KillsWhatTakesTooLong) {
  const std::string list = folder_.Write("list.txt", Sample(0) + "\n" + Sample(1) + "\n");
  const ProgramResult run =
      RunProgram({"batch", "diagnose", list, "-o", Out(), "--timeout", "0.03"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(RowOf(folder_ / "out", "sample_0").at("status"), "timed out");
  EXPECT_EQ(RowOf(folder_ / "out", "sample_1").at("status"), "timed out");
  EXPECT_TRUE(fs::is_empty(folder_ / "out/items"));
}

/// Somebody kills an item: a row, and the others go on.
TEST_F(BatchCommand, GoesOnWhenAnItemCrashes) {
  const std::string list = folder_.Write("list.txt", Sample(2) + "\nabsent\n");
  const pid_t batch = Begin({"batch", "diagnose", list, "-o", Out(), "--jobs", "1"}, folder_ / "");
  std::vector<pid_t> items;
  for (int i = 0; i < 2000 && items.empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    items = Below(batch, "flextip-item");
  }
  ASSERT_EQ(items.size(), 1U);
  kill(items[0], SIGKILL);
  EXPECT_EQ(ExitCodeOf(batch), 1);
  EXPECT_EQ(RowOf(folder_ / "out", "sample_2").at("status"), "crashed SIGKILL");
  EXPECT_EQ(RowOf(folder_ / "out", "sample_2").at("exit_code"), "137");
  EXPECT_EQ(RowOf(folder_ / "out", "absent").at("status"), "failed");
  EXPECT_TRUE(fs::is_empty(folder_ / "out/items"));
}

/// Threads of an item while it works, and while it works as one of two.
TEST_F(BatchCommand, SharesTheCoresAmongItsItems) {
  if (std::thread::hardware_concurrency() != 2) GTEST_SKIP() << "is counted on two cores";
  const std::string list = folder_.Write("list.txt", Sample(2) + "\n");
  for (const int jobs : {1, 2}) {
    const pid_t batch = Begin({"batch", "diagnose", list, "-o", Out(std::to_string(jobs)), "--jobs",
                               std::to_string(jobs), "--", "--no-closed-loop"},
                              folder_ / "");
    std::ptrdiff_t most = 0;
    while (waitpid(batch, nullptr, WNOHANG) == 0) {
      for (const pid_t item : Below(batch, "flextip-item")) {
        std::error_code error;
        const fs::directory_iterator tasks("/proc/" + std::to_string(item) + "/task", error);
        if (!error) most = std::max(most, std::distance(begin(tasks), end(tasks)));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    // The item's own and the one that waits for Ctrl-C, and a worker where there is a core for it.
    EXPECT_EQ(most, jobs == 1 ? 3 : 2);
  }
}

TEST_F(BatchCommand, RefusesAnOutThatIsThere) {
  folder_.Write("out/file", "mine");
  const std::string list = CheckList();
  EXPECT_TRUE(IsRefused(RunProgram({"batch", "check", list, "-o", Out()}),
                        {"out: exists and is not empty"}));
  EXPECT_TRUE(IsRefused(RunProgram({"batch", "check", list, "-o", Out(), "--resume"}),
                        {"out: no batch.json, expected the folder of a batch"}));
  EXPECT_EQ(ReadText(folder_ / "out/file"), "mine");
}

}  // namespace
}  // namespace flextip::batch_test
