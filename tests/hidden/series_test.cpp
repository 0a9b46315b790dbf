// Recordings of one instrument, one after the other: what is the same in all, and what is not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "testdata/hidden/recording.h"

namespace flextip::hidden {
namespace {

using testing::ElementsAre;

HiddenSeries ThreeOf(std::vector<std::string> effects, std::vector<std::string> later, int begin) {
  HiddenSeries series{.recordings = 3, .later = std::move(later), .begin = begin};
  series.options.effects = std::move(effects);
  series.options.scene.duration_s = 2.0;
  return series;
}

TEST(HiddenSeries, TheFirstIsTheRecordingByItself) {
  const HiddenSeries series = ThreeOf({"stiffness"}, {}, 1);
  const auto all = MakeHiddenSeries(series, 5);
  const HiddenRecording alone = MakeHidden(series.options, 5);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].label.parameters, alone.label.parameters);
  const auto &ours = all[0].recording.em0->samples, &its = alone.recording.em0->samples;
  ASSERT_EQ(ours.size(), its.size());
  for (std::size_t k = 0; k < ours.size(); ++k) EXPECT_EQ(ours[k].value.p_RS, its[k].value.p_RS);
}

TEST(HiddenSeries, InstrumentRoomAndTruthAreShared) {
  const auto all = MakeHiddenSeries(ThreeOf({"stiffness"}, {}, 1), 6);
  for (const HiddenRecording& one : all) {
    EXPECT_EQ(one.recording.instrument.length_m, all[0].recording.instrument.length_m);
    EXPECT_EQ(one.recording.p_RP, all[0].recording.p_RP);
    EXPECT_EQ(one.recording.em0->position_noise_m, all[0].recording.em0->position_noise_m);
    EXPECT_EQ(one.recording.cam0->calibration.T_RC.p, all[0].recording.cam0->calibration.T_RC.p);
    auto label = one.label.parameters, first = all[0].label.parameters;
    for (const char* own : {"port_motion", "em_interference"}) {
      label[own].erase("phase_rad");
      first[own].erase("phase_rad");
    }
    EXPECT_EQ(label, first);
  }
  const auto wrist = [&](int r) { return all[r].recording.wrist0->samples[20].value.p_RW; };
  EXPECT_GT((wrist(0) - wrist(1)).norm(), 1e-3);
  EXPECT_GT((wrist(1) - wrist(2)).norm(), 1e-3);
}

TEST(HiddenSeries, WhatBeginsIsThereFromThenOn) {
  const auto all = MakeHiddenSeries(ThreeOf({"length"}, {"stiffness"}, 2), 7);
  EXPECT_THAT(all[0].label.present, ElementsAre("length"));
  EXPECT_THAT(all[1].label.present, ElementsAre("length"));
  EXPECT_THAT(all[2].label.present, ElementsAre("length", "stiffness"));
  const auto scale = [&](int r) { return all[r].label.parameters.at("stiffness").at("scale")[0]; };
  EXPECT_EQ(scale(0), scale(1));
  EXPECT_LT(std::abs(scale(1) - 1.0), 0.04 + 1e-12);
  EXPECT_GT(std::abs(scale(2) - 1.0), 0.1);
  EXPECT_EQ(all[0].label.parameters.at("length"), all[2].label.parameters.at("length"));
  EXPECT_EQ(all[0].label.parameters.at("backlash"), all[2].label.parameters.at("backlash"));
}

}  // namespace
}  // namespace flextip::hidden
