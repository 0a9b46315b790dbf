// The campaign's runs are even, and the same by their seed.
#include "bench/fault_campaign/draw.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace flextip::bench {
namespace {

TEST(FaultDraw, EachFaultAndSizeHasItsShare) {
  std::map<std::string, int> faults;
  std::map<int, int> sizes, moves, controllers;
  const int rounds = 4, round = static_cast<int>(FaultChoices().size()) + 6;
  for (int i = 0; i < rounds * round; ++i) {
    const FaultRun run = DrawRun(1, i);
    if (run.faults.size() == 1) ++faults[run.FaultText()];
    ++sizes[run.size];
    ++moves[static_cast<int>(run.base.move)];
    ++controllers[static_cast<int>(run.base.controller)];
  }
  EXPECT_EQ(faults.size(), FaultChoices().size());
  for (const auto& [fault, runs] : faults) EXPECT_EQ(runs, rounds) << fault;
  for (const auto* counts : {&sizes, &moves, &controllers}) {
    const auto [least, most] =
        std::minmax_element(counts->begin(), counts->end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; });
    EXPECT_LE(most->second - least->second, 1);
  }
}

TEST(FaultDraw, EveryKindOfFaultIsThere) {
  std::set<simulation::FaultKind> kinds;
  for (const FaultChoice& choice : FaultChoices()) {
    kinds.insert(choice.kind);
    EXPECT_TRUE(simulation::CanHave(choice.stream, choice.kind));
  }
  EXPECT_EQ(kinds.size(), static_cast<std::size_t>(simulation::kFaultKinds));
}

TEST(FaultDraw, ASuiteHasTheSensorOfItsFault) {
  for (int i = 0; i < 500; ++i) {
    const FaultRun run = DrawRun(2, i);
    for (const simulation::Fault& fault : run.faults)
      EXPECT_TRUE(Has(run.base.suite, fault.stream)) << run.FaultText();
  }
}

TEST(FaultDraw, IsTheSameByItsSeed) {
  int different = 0;
  for (int i = 0; i < 100; ++i) {
    const FaultRun one = DrawRun(3, i), again = DrawRun(3, i), other = DrawRun(4, i);
    EXPECT_EQ(one.FaultText(), again.FaultText());
    EXPECT_EQ(one.base, again.base);
    different += one.FaultText() != other.FaultText();
  }
  EXPECT_GT(different, 50);
}

TEST(FaultDraw, FaultsBeginWithinTheRun) {
  for (int i = 0; i < 500; ++i) {
    FaultRun run = DrawRun(5, i);
    StartAt(2.0, run);
    EXPECT_GE(run.faults.front().start_s, 0.2);
    EXPECT_LE(run.faults.front().start_s, 1.5);
    EXPECT_LT(run.faults.back().start_s - run.faults.front().start_s, 0.5);
  }
}

}  // namespace
}  // namespace flextip::bench
