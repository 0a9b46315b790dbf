#include "batch/run.h"

#include <gmock/gmock.h>

#include <csignal>
#include <set>

#include "core/error.h"
#include "tests/batch/work_of_tests.h"

namespace flextip::batch {
namespace {

using testing::ElementsAre;

std::vector<Item> Mixed(int count) {
  const std::vector<std::vector<std::string>> kinds{
      {"ok"}, {"exit", "1"}, {"segv"}, {"payload", "1000"}, {"throw"}, {"ok"}};
  std::vector<Item> items;
  for (int i = 0; i < count; ++i) items.push_back({"item" + std::to_string(i), kinds[i % 6]});
  return items;
}

TEST(BatchRun, EndsEveryItemOnce) {
  for (const int jobs : {1, 2, 5}) {
    Pool pool(DoAsTold, {.jobs = jobs});
    const std::vector<Item> items = Mixed(60);
    std::multiset<std::size_t> seen;
    int ok = 0;
    RunItems(pool, items, [&](const std::vector<Ended>& ended) {
      for (const Ended& one : ended) {
        seen.insert(one.index);
        EXPECT_EQ(one.outcome.name, items[one.index].name);
        ok += one.outcome.status == Status::kOk;
      }
    });
    EXPECT_EQ(seen.size(), 60U);
    EXPECT_EQ(std::set<std::size_t>(seen.begin(), seen.end()).size(), 60U);
    EXPECT_EQ(ok, 30);
  }
}

TEST(BatchRun, BeginsTheLargestFirst) {
  const std::vector<Item> items{
      {"a", {"ok"}, 1}, {"b", {"ok"}, 0}, {"c", {"ok"}, 9}, {"d", {"ok"}, 9}, {"e", {"ok"}, 5}};
  EXPECT_THAT(LargestFirst(items), ElementsAre(2, 3, 4, 0, 1));
  Pool pool(DoAsTold, {});
  std::vector<std::size_t> order;
  RunItems(pool, items, [&](const std::vector<Ended>& ended) {
    for (const Ended& one : ended) order.push_back(one.index);
  });
  EXPECT_THAT(order, ElementsAre(2, 3, 4, 0, 1));
}

TEST(BatchRun, StopsWhenItsCallerThrows) {
  Pool pool(DoAsTold, {});
  int told = 0;
  const auto refuse = [&](const std::vector<Ended>&) {
    ++told;
    throw WorkError("the disk is full");
  };
  EXPECT_THROW(RunItems(pool, Mixed(20), refuse), WorkError);
  EXPECT_EQ(told, 1);
}

TEST(BatchRun, StopsOnAnInterrupt) {
  const StopSignals signals;
  Pool pool(DoAsTold, {});
  int told = 0;
  RunItems(pool, {{"a", {"ok"}}, {"b", {"sleep", "60"}}}, [&](const std::vector<Ended>&) {
    ++told;
    raise(SIGINT);
  });
  EXPECT_EQ(told, 1);
  EXPECT_EQ(StopSignals::Caught(), SIGINT);
}

}  // namespace
}  // namespace flextip::batch
