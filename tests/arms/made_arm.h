// Small arms and recordings of them for tests.
#pragma once

#include <Eigen/Dense>
#include <random>

#include "recording/recording.h"

namespace flextip::arms {

/// Six joints, the third of them prismatic, by modified Denavit-Hartenberg numbers.
Arm SixJoints();
/// Three revolute joints with masses.
Arm ThreeJointsWithMasses();

/// A smooth motion of all joints: `rows` samples at `rate_hz`.
JointStream SmoothMotion(const Arm& arm, int rows, double rate_hz, unsigned seed);
/// Stops at random joints.
JointStream Stops(const Arm& arm, int rows, unsigned seed);

/// The stream with normal noise of these deviations, a joint each.
JointStream WithNoise(const JointStream& stream, const std::vector<double>& sd, unsigned seed);

/// A recording of an arm without a shaft.
Recording ArmRecording(const Arm& arm);

}  // namespace flextip::arms
