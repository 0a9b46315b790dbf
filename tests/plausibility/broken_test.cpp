// Recordings made wrong in known ways: each is to be named.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "plausibility/check_recording.h"
#include "testdata/broken/broken_recording.h"
#include "testdata/hidden/recording.h"
#include "tests/plausibility/all_streams.h"

namespace flextip {
namespace {

constexpr int kRecordings = 5;  // a way

/// A healthy recording with a load, and with all streams.
Recording Base(std::uint64_t seed, hidden::LoadKind load) {
  hidden::SceneDraw scene;
  scene.family = hidden::MotionFamily::kAny;
  scene.load = load;
  return WithAllStreams(scene, seed);
}

std::vector<Recording> Bases(std::uint64_t first_seed, bool hung_mass) {
  std::vector<Recording> bases;
  for (int i = 0; i < kRecordings; ++i) {
    const auto load = hung_mass    ? hidden::LoadKind::kHungMass
                      : i % 2 == 0 ? hidden::LoadKind::kVarying
                                   : hidden::LoadKind::kTissue;
    bases.push_back(Base(first_seed + static_cast<std::uint64_t>(i), load));
  }
  return bases;
}

bool NeedsHungMass(const broken::BrokenWay& way) {
  return std::count(way.needs.begin(), way.needs.end(), "hung mass") > 0;
}

bool IsNamed(const plausibility::CheckResult& result, const std::string& id) {
  return std::any_of(result.findings.begin(), result.findings.end(),
                     [&](const plausibility::Finding& f) { return f.id == id; });
}

/// Findings of the wrong kind beside the right one.
int OthersWrong(const plausibility::CheckResult& result, const std::string& id) {
  return static_cast<int>(std::count_if(
      result.findings.begin(), result.findings.end(),
      [&](const auto& f) { return f.id != id && f.severity == plausibility::Severity::kWrong; }));
}

TEST(BrokenRecordings, AreNamed) {
  ASSERT_GE(broken::BrokenWays().size(), 40U);
  const auto bases = Bases(2000, false), hung = Bases(2100, true);
  int named = 0, all = 0, others = 0;
  for (const broken::BrokenWay& way : broken::BrokenWays()) {
    int of_way = 0, others_of_way = 0;
    std::uint64_t seed = 1;
    for (const Recording& base : NeedsHungMass(way) ? hung : bases) {
      broken::Rng rng(seed++);
      const auto result = plausibility::CheckRecording(broken::BreakRecording(base, way, rng));
      if (IsNamed(result, way.finding)) ++of_way;
      others_of_way += OthersWrong(result, way.finding);
    }
    if (of_way < kRecordings || others_of_way > 0)
      std::printf("%s: named %d of %d, %d other findings\n", way.name.c_str(), of_way, kRecordings,
                  others_of_way);
    named += of_way;
    all += kRecordings;
    others += others_of_way;
  }
  std::printf("named %d of %d, with %d other findings\n", named, all, others);
  EXPECT_GE(all, 200);
  EXPECT_GE(named, 0.95 * all);
  EXPECT_LE(others, 0.05 * all);
}

TEST(BrokenRecordings, AFindingHasNumbersAndAMend) {
  const Recording base = Base(2000, hidden::LoadKind::kVarying);
  broken::Rng rng(1);
  const auto result =
      plausibility::CheckRecording(broken::BreakRecording(base, broken::BrokenWays().front(), rng));
  ASSERT_EQ(result.findings.size(), 1U);
  EXPECT_EQ(result.findings[0].severity, plausibility::Severity::kWrong);
  EXPECT_THAT(result.findings[0].text, testing::StartsWith("em0: positions look like millimetres"));
  EXPECT_THAT(result.findings[0].text, testing::ContainsRegex("[0-9]+ m"));
  EXPECT_THAT(result.findings[0].mend, testing::HasSubstr("--unit em0=mm"));
}

/// Two faults at once are two findings.
TEST(BrokenRecordings, TwoFaultsAreBothNamed) {
  const Recording base = Base(2000, hidden::LoadKind::kVarying);
  broken::Rng rng(1);
  Recording broken = base;
  for (const broken::BrokenWay& way : broken::BrokenWays())
    if (way.name == "em0 in mm" || way.name == "load0 sign") way.make(broken, rng);
  const auto result = plausibility::CheckRecording(broken);
  EXPECT_TRUE(IsNamed(result, "em0.unit"));
  EXPECT_TRUE(IsNamed(result, "load0.sign"));
  EXPECT_EQ(result.findings.size(), 2U);
}

/// Numbers that no transformation explains: said so.
TEST(BrokenRecordings, WhatFitsNothingIsUnexplained) {
  Recording broken = Base(2000, hidden::LoadKind::kVarying);
  broken::Rng rng(1);
  double phase = 0.0;
  for (auto& s : broken.em0->samples) {
    phase += 0.02;
    s.value.p_RS = Eigen::Vector3d(0.3 * std::sin(3.1 * phase), 0.4 * std::cos(1.7 * phase),
                                   0.35 * std::sin(0.6 * phase));
  }
  const auto result = plausibility::CheckRecording(broken);
  EXPECT_TRUE(IsNamed(result, "em0.unexplained"));
}

}  // namespace
}  // namespace flextip
