#include "tests/arms/made_arm.h"

#include <cmath>
#include <numbers>

namespace flextip::arms {
namespace {

constexpr TimeNs kStart_ns = 1'000'000'000;

ArmJoint Joint(JointType type, double a, double alpha, double d, double theta) {
  ArmJoint joint;
  joint.type = type;
  joint.a_m = a;
  joint.alpha_rad = alpha;
  joint.d_m = d;
  joint.theta_rad = theta;
  PlaceJoint(ArmConvention::kModifiedDh, joint);
  return joint;
}

JointStream Empty(const Arm& arm, double rate_hz) {
  JointStream stream;
  stream.rate_hz = rate_hz;
  for (const ArmJoint& joint : arm.joints) stream.types.push_back(joint.type);
  stream.noise.assign(arm.joints.size(), 0.0);
  return stream;
}

}  // namespace

Arm SixJoints() {
  constexpr double right = std::numbers::pi / 2;
  Arm arm;
  arm.joints = {Joint(JointType::kRevolute, 0.0, right, 0.0, right),
                Joint(JointType::kRevolute, 0.02, -right, 0.01, -right),
                Joint(JointType::kPrismatic, 0.0, right, -0.3, 0.2),
                Joint(JointType::kRevolute, 0.0, 0.1, 0.25, 0.0),
                Joint(JointType::kRevolute, 0.0, -right, 0.0, -right),
                Joint(JointType::kRevolute, 0.03, -right, 0.0, -right)};
  return arm;
}

Arm ThreeJointsWithMasses() {
  constexpr double right = std::numbers::pi / 2;
  Arm arm;
  arm.joints = {Joint(JointType::kRevolute, 0.0, 0.3, 0.2, 0.0),
                Joint(JointType::kRevolute, 0.05, right, 0.0, 0.4),
                Joint(JointType::kPrismatic, 0.3, 0.2, 0.1, 0.1)};
  arm.links = {{2.0, {0.01, 0.0, 0.05}}, {1.5, {0.15, 0.02, 0.0}}, {0.8, {0.1, 0.0, 0.02}}};
  arm.payload_places = {{"tip", 3, {0.2, 0.0, 0.0}}};
  return arm;
}

JointStream SmoothMotion(const Arm& arm, int rows, double rate_hz, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  JointStream stream = Empty(arm, rate_hz);
  const int n = arm.Size();
  Eigen::MatrixXd phase(n, 3), frequency(n, 3);
  for (int i = 0; i < n; ++i)
    for (int m = 0; m < 3; ++m) {
      phase(i, m) = 2.0 * std::numbers::pi * unit(rng);
      frequency(i, m) = 0.1 + 0.5 * unit(rng);
    }
  for (int k = 0; k < rows; ++k) {
    const double t = double(k) / rate_hz;
    Eigen::VectorXd q(n);
    for (int i = 0; i < n; ++i) {
      const double size = arm.joints[i].type == JointType::kRevolute ? 0.25 : 0.03;
      q[i] = arm.joints[i].type == JointType::kRevolute ? 0.1 : 0.15;
      for (int m = 0; m < 3; ++m)
        q[i] += size * std::sin(2.0 * std::numbers::pi * frequency(i, m) * t + phase(i, m));
    }
    stream.q.push_back({kStart_ns + TimeNs(std::llround(1e9 * t)), q});
  }
  return stream;
}

JointStream Stops(const Arm& arm, int rows, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  JointStream stream = Empty(arm, 1.0);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(arm.Size());
  for (int k = 0; k < rows; ++k) {
    for (int i = 0; i < arm.Size(); ++i) {
      const double size = arm.joints[i].type == JointType::kRevolute ? 0.2 : 0.02;
      q[i] = 0.8 * q[i] + size * normal(rng);
    }
    stream.q.push_back({kStart_ns + TimeNs(k) * 1'000'000'000, q});
  }
  return stream;
}

JointStream WithNoise(const JointStream& stream, const std::vector<double>& sd, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  JointStream noisy = stream;
  noisy.noise = sd;
  for (auto& sample : noisy.q)
    for (Eigen::Index i = 0; i < sample.value.size(); ++i) sample.value[i] += sd[i] * normal(rng);
  return noisy;
}

Recording ArmRecording(const Arm& arm) {
  Recording recording;
  recording.has_shaft = false;
  recording.arm = arm;
  return recording;
}

}  // namespace flextip::arms
