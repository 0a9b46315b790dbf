#include <gtest/gtest.h>

#include "reproduction/chapter5/sensor_loop.h"

namespace flextip::reproduction {
namespace {

constexpr SensorSet kAll{.name = "all",
                         .load = true,
                         .strain = true,
                         .em_direction = true,
                         .em_position = true,
                         .tip = true,
                         .tip_direction = true};

SensorRun LoopOf(const SensorSet& sensors, SensorModel model, SensorMove move, double port_off_m,
                 double port_prior_m, bool window) {
  return RunSensorCase({.sensors = sensors,
                        .model = model,
                        .move = move,
                        .port_off_m = port_off_m,
                        .port_prior_m = port_prior_m,
                        .window = window});
}

TEST(SensorLoop, TheRodWithEverySensorKeepsToThePath) {
  for (const auto move : {SensorMove::kPress, SensorMove::kLateral}) {
    const SensorRun straight = LoopOf(kAll, SensorModel::kStraight, move, 0.003, 0.003, false);
    const SensorRun rod = LoopOf(kAll, SensorModel::kRod, move, 0.003, 0.003, true);
    EXPECT_FALSE(rod.lost);
    EXPECT_EQ(rod.without_model, 0);
    EXPECT_LT(rod.path_max_m, 0.7 * straight.path_max_m);
    EXPECT_LT(rod.tip_rms_m, 0.0003);
    EXPECT_GT(rod.path_max_m, rod.path_rms_m);
  }
}

TEST(SensorLoop, WhatCannotBeSeenIsLeftToTheStraightShaftAndSaidSo) {
  // One direction of the wrist, load and port both in doubt.
  const SensorSet wrist{.name = "wrist only"};
  const SensorRun straight =
      LoopOf(wrist, SensorModel::kStraight, SensorMove::kPress, 0.003, 0.003, false);
  for (const bool window : {false, true}) {
    const SensorRun rod =
        LoopOf(wrist, SensorModel::kRod, SensorMove::kPress, 0.003, 0.003, window);
    EXPECT_EQ(rod.without_model, rod.updates);
    EXPECT_NEAR(rod.path_max_m, straight.path_max_m, 1e-4);
  }
  // With the port known, the same sensors see the load.
  const SensorRun known = LoopOf(wrist, SensorModel::kRod, SensorMove::kPress, 0.0, 0.0003, false);
  EXPECT_EQ(known.without_model, 0);
  EXPECT_LT(known.path_max_m, 0.5 * straight.path_max_m);
}

TEST(SensorLoop, AWindowMakesUpForAWrongPort) {
  const SensorSet load{.name = "load", .load = true};
  const SensorRun trusting =
      LoopOf(load, SensorModel::kRod, SensorMove::kLateral, 0.003, 0.0003, false);
  const SensorRun window =
      LoopOf(load, SensorModel::kRod, SensorMove::kLateral, 0.003, 0.003, true);
  EXPECT_LT(window.tip_rms_m, 0.5 * trusting.tip_rms_m);
}

}  // namespace
}  // namespace flextip::reproduction
