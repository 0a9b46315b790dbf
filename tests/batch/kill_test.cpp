// A campaign that is killed at any moment goes on where it was: nothing lost, nothing twice.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "batch/line_file.h"
#include "batch/run.h"
#include "tests/batch/work_of_tests.h"

namespace flextip::batch {
namespace {

constexpr int kItems = 40;

std::vector<Item> NotDone(const std::filesystem::path& records) {
  std::set<std::string> done;
  for (const std::string& line : WholeLines(records)) done.insert(UnpackOutcome(line).name);
  std::vector<Item> items;
  for (int i = 0; i < kItems; ++i) {
    const std::string name = "item" + std::to_string(i);
    if (!done.contains(name)) items.push_back({name, {"sleep", "0.02"}});
  }
  return items;
}

/// A campaign in a process of its own. Returns its process, and through `starter` the one that
/// starts its items.
pid_t Campaign(const std::filesystem::path& records, pid_t& starter) {
  int ends[2];
  if (pipe(ends) != 0) return -1;
  const pid_t process = fork();
  if (process == 0) {
    try {
      Pool pool(DoAsTold, {.jobs = 2});
      const pid_t id = pool.process();
      if (write(ends[1], &id, sizeof id) != sizeof id) _exit(1);
      LineFile file(records);
      RunItems(pool, NotDone(records), [&](const std::vector<Ended>& ended) {
        std::vector<std::string> lines;
        for (const Ended& one : ended) lines.push_back(Pack(one.outcome));
        file.Append(lines);
      });
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  }
  close(ends[1]);
  if (read(ends[0], &starter, sizeof starter) != sizeof starter) starter = -1;
  close(ends[0]);
  return process;
}

/// A dead process whose new parent has not asked for it yet (a zombie) runs no more.
bool Runs(pid_t process) {
  std::ifstream stat(fmt::format("/proc/{}/stat", process));
  std::string id, name, state;
  return stat >> id >> name >> state && state != "Z" && state != "X";
}

TEST(BatchKilled, GoesOnWhereItWas) {
  const BatchTestFolder folder;
  const std::filesystem::path records = folder / "records";
  std::mt19937 random(20261124);
  std::uniform_real_distribution<double> moment_s(0.0, 0.06);
  int kills = 0;
  while (true) {
    pid_t starter = -1;
    const pid_t campaign = Campaign(records, starter);
    ASSERT_GT(starter, 0);
    std::this_thread::sleep_for(std::chrono::duration<double>(moment_s(random)));
    if (kills < 25) kill(kills % 2 == 0 ? campaign : starter, SIGKILL);
    ++kills;
    int status = 0;
    waitpid(campaign, &status, 0);
    for (int i = 0; i < 500 && Runs(starter); ++i) {  // dies with the campaign, or is dead
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_FALSE(Runs(starter));
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && NotDone(records).empty()) break;
    ASSERT_LT(kills, 60);
  }
  EXPECT_GT(kills, 3);
  std::map<std::string, int> times;
  for (const std::string& line : WholeLines(records)) {
    const Outcome outcome = UnpackOutcome(line);
    ++times[outcome.name];
    EXPECT_EQ(outcome.status, Status::kOk) << line;
  }
  EXPECT_EQ(times.size(), static_cast<std::size_t>(kItems));
  for (const auto& [name, count] : times) EXPECT_EQ(count, 1) << name;
}

}  // namespace
}  // namespace flextip::batch
