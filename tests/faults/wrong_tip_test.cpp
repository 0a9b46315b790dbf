// A wrong tip under each suite of sensors, with the supervisor's defaults: how far the true tip
// goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "bench/fault_campaign/base.h"

namespace flextip::bench {
namespace {

using simulation::Fault;
using simulation::FaultKind;
using simulation::FaultStream;

constexpr double kStart_s = 1.0;

struct WrongTip {
  const char* name;
  FaultKind kind;
  double size, duration_s;
};
// One tip and ten that are 20 mm wrong, one that drifts by 1 mm a cycle, one that is frozen.
constexpr WrongTip kWrongTips[] = {{"one", FaultKind::kOffset, 0.02, 0.03},
                                   {"ten", FaultKind::kOffset, 0.02, 0.34},
                                   {"drift", FaultKind::kDrift, 0.03, 1.0},
                                   {"frozen", FaultKind::kStuck, 0.0, 1.0}};

/// The largest deviation of the true tip from the press's path, in mm.
double Deviation_mm(Suite suite, const WrongTip& wrong, SupervisionKind kind) {
  Base base;
  base.suite = suite;
  base.seed = 3;
  simulation::LoopSetup setup = SetupOf(base);
  setup.supervision.kind = kind;
  setup.faults = {{wrong.kind, FaultStream::kTip, kStart_s, wrong.duration_s, wrong.size}};
  setup.resume_s = kStart_s + wrong.duration_s + 1.0;
  setup.max_s = 12.0;
  const simulation::LoopResult result = RunClosedLoop(setup, nullptr);
  double largest_m = 0.0;
  for (const simulation::LoopUpdate& update : result.updates)
    largest_m = std::max(largest_m, update.deviation_m);
  return 1e3 * largest_m;
}

TEST(WrongTip, MovesTheTrueTipByNoMoreThanAHealthyOneDoes) {
  const WrongTip none{"none", FaultKind::kOffset, 0.0, 0.1};
  for (const Suite suite : {Suite::kVision, Suite::kVisionEm, Suite::kAll}) {
    const double healthy_mm = Deviation_mm(suite, none, SupervisionKind::kNone);
    for (const WrongTip& wrong : kWrongTips) {
      const double alone_mm = Deviation_mm(suite, wrong, SupervisionKind::kNone);
      const double guarded_mm = Deviation_mm(suite, wrong, SupervisionKind::kFull);
      const std::string what = std::string(Name(suite)) + ", " + wrong.name;
      RecordProperty(what, std::to_string(healthy_mm) + " " + std::to_string(alone_mm) + " " +
                               std::to_string(guarded_mm));
      EXPECT_GT(alone_mm, 4.0) << what;
      EXPECT_LT(guarded_mm, healthy_mm + 0.5) << what;
    }
  }
}

}  // namespace
}  // namespace flextip::bench
