#include "batch/pool.h"

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include "core/error.h"
#include "tests/batch/work_of_tests.h"
#include "tests/repetitions.h"

namespace flextip::batch {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

Outcome OneBy(Pool& pool, const std::vector<std::string>& arguments) {
  pool.Start(7, {"item", arguments});
  while (true) {
    const auto ended = pool.Wait(-1);
    if (ended.empty()) continue;
    EXPECT_EQ(ended.size(), 1U);
    EXPECT_EQ(ended[0].index, 7U);
    EXPECT_EQ(ended[0].outcome.name, "item");
    return ended[0].outcome;
  }
}

TEST(Pool, TellsHowEachItemEnded) {
  Pool pool(DoAsTold, {});
  EXPECT_EQ(StatusText(OneBy(pool, {"ok"})), "ok");
  const Outcome failed = OneBy(pool, {"exit", "3"});
  EXPECT_EQ(StatusText(failed), "failed");
  EXPECT_EQ(failed.exit_code, 3);
  const Outcome threw = OneBy(pool, {"throw"});
  EXPECT_EQ(StatusText(threw), "failed");
  EXPECT_EQ(threw.exit_code, 1);
  EXPECT_EQ(threw.payload, "thrown by item");
  const Outcome crashed = OneBy(pool, {"segv"});
  EXPECT_EQ(StatusText(crashed), "crashed SIGSEGV");
  EXPECT_EQ(crashed.exit_code, -1);
  EXPECT_EQ(StatusText(OneBy(pool, {"abort"})), "crashed SIGABRT");
  EXPECT_EQ(StatusText(OneBy(pool, {"ok"})), "ok");
}

TEST(Pool, BringsLargePayloadsWhole) {
  Pool pool(DoAsTold, {});
  const Outcome outcome = OneBy(pool, {"payload", "3000000"});
  EXPECT_EQ(outcome.payload, std::string(3'000'000, 'x') + "\t\n\\t");
}

TEST(Pool, KillsWhatTakesTooLong) {
  Pool pool(DoAsTold, {.timeout_s = 0.2});
  const auto begin = Clock::now();
  const Outcome outcome = OneBy(pool, {"sleep", "60"});
  EXPECT_EQ(StatusText(outcome), "timed out");
  EXPECT_GE(outcome.seconds, 0.2);
  EXPECT_LT(SecondsSince(begin), 20.0);
  EXPECT_EQ(StatusText(OneBy(pool, {"ok"})), "ok");
}

TEST(Pool, RunsItemsBesideEachOther) {
  Pool pool(DoAsTold, {.jobs = 4});
  const auto begin = Clock::now();
  for (std::size_t i = 0; i < 4; ++i) pool.Start(i, {"s", {"sleep", "1"}});
  EXPECT_FALSE(pool.HasRoom());
  for (std::size_t n = 0; n < 4;) n += pool.Wait(-1).size();
  EXPECT_EQ(pool.running(), 0);
  EXPECT_LT(SecondsSince(begin), 3.5);  // one after the other: 4 s
}

TEST(Pool, LeavesNoProcessOfAnItemBehind) {
  const BatchTestFolder folder;
  {
    Pool pool(DoAsTold, {});
    EXPECT_EQ(StatusText(OneBy(pool, {"orphan", folder / "orphan"})), "ok");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  EXPECT_FALSE(std::filesystem::exists(folder / "orphan"));
}

TEST(Pool, EndsItsItemsWithItself) {
  const BatchTestFolder folder;
  const auto begin = Clock::now();
  {
    Pool pool(DoAsTold, {.jobs = 2});
    pool.Start(0, {"a", {"sleep", "60"}});
    pool.Start(1, {"b", {"sleep", "60"}});
    pool.Wait(0.1);
  }
  EXPECT_LT(SecondsSince(begin), 20.0);
}

TEST(Pool, SaysThatTheProcessThatStartsItemsWasKilled) {
  Pool pool(DoAsTold, {});
  pool.Start(0, {"a", {"sleep", "60"}});
  kill(pool.process(), SIGKILL);
  try {
    while (true) pool.Wait(-1);
  } catch (const WorkError& error) {
    EXPECT_THAT(error.what(), HasSubstr("was killed"));
  }
}

/// What an item does to its memory stays its own.
TEST(Pool, StartsEachItemAsTheFirst) {
  int counter = 0;
  Pool pool(
      [&](const Item&, std::string& payload) {
        payload = std::to_string(++counter);
        return 0;
      },
      {});
  EXPECT_EQ(OneBy(pool, {}).payload, "1");
  EXPECT_EQ(OneBy(pool, {}).payload, "1");
  EXPECT_EQ(counter, 0);
}

TEST(Pool, ForksFromAProcessOfOneThread) {
  const auto threads = [](const Item&, std::string& payload) {
    const auto tasks = std::filesystem::directory_iterator("/proc/self/task");
    payload = std::to_string(std::distance(begin(tasks), end(tasks)));
    return 0;
  };
  Pool pool(threads, {});
  EXPECT_EQ(OneBy(pool, {}).payload, kThreadSanitized ? "2" : "1");
}

}  // namespace
}  // namespace flextip::batch
