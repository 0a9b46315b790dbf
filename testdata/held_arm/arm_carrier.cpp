#include "testdata/held_arm/arm_carrier.h"

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "core/error.h"

namespace flextip::hidden {
namespace {

constexpr double kRate_hz = 200.0;
constexpr double kSettles_s = 0.3;  // before the course begins: the plant comes to rest
constexpr double kEncoderNoise_rad = 2e-5, kEncoderNoise_m = 5e-6;
constexpr double kWristNoise_m = 1e-5;  // what these make of it

bool Turns(const Arm& arm, int i) { return arm.joints[i].type == JointType::kRevolute; }

Eigen::VectorXd Middle(const Arm& arm) {
  Eigen::VectorXd q(arm.Size());
  for (int i = 0; i < arm.Size(); ++i) q[i] = Turns(arm, i) ? 0.3 : 0.15;
  return q;
}

/// The orientation of the last link.
Eigen::Matrix3d LinkOf(const Arm& arm, const Eigen::VectorXd& q) {
  return simulation::ChainOfLinks(arm).Frame(q, arm.Size() - 1).topLeftCorner<3, 3>();
}

Eigen::VectorXd Or(const Eigen::VectorXd& list, int size) {
  return list.size() > 0 ? list : Eigen::VectorXd(Eigen::VectorXd::Zero(size));
}

}  // namespace

ArmCarrier::ArmCarrier(const Arm& arm, const simulation::ArmFaults& faults, bool keep_wrist,
                       std::uint64_t seed)
    : arm_(arm), faults_(faults), keep_wrist_(keep_wrist), seed_(seed), true_arm_(arm) {}

Eigen::Vector3d ArmCarrier::WristOf(const Arm& arm, const Eigen::VectorXd& q) const {
  const Eigen::Matrix4d T = simulation::ChainOfLinks(arm).Frame(q, arm.Size() - 1);
  const Eigen::Vector3d p_LK = arm.T_LK ? arm.T_LK->p : Eigen::Vector3d(0.0, 0.0, 0.0);
  return (T * p_LK.homogeneous()).head<3>();
}

/// Newton from joints nearby, derivatives by differences.
Eigen::VectorXd ArmCarrier::JointsFor(const Eigen::Vector3d& p_RW, Eigen::VectorXd q) const {
  constexpr double kStep = 1e-6, kNear_m = 1e-9;
  for (int round = 0; round < 30; ++round) {
    const Eigen::Vector3d off = p_RW - WristOf(arm_, q);
    if (off.norm() < kNear_m) return q;
    Eigen::MatrixXd J(3, q.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      Eigen::VectorXd up = q, down = q;
      up[j] += kStep;
      down[j] -= kStep;
      J.col(j) = (WristOf(arm_, up) - WristOf(arm_, down)) / (2.0 * kStep);
    }
    q += J.completeOrthogonalDecomposition().solve(off);
  }
  throw WorkError(fmt::format("the arm does not reach [{}, {}, {}]", p_RW.x(), p_RW.y(), p_RW.z()));
}

void ArmCarrier::Follow(const Course& course, double from_s, double to_s) {
  const int n = arm_.Size();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const int rows = int(std::ceil((to_s - from_s) * kRate_hz)) + 1;
  for (int k = 0; k < rows; ++k) middle += course(from_s + k / kRate_hz) / rows;
  Eigen::VectorXd q = Middle(arm_);
  arm_.T_RB.p += middle - WristOf(arm_, q);
  const int settling = int(kSettles_s * kRate_hz);
  from_s_ = from_s - kSettles_s;
  commands_.resize(rows + settling, n);
  q = JointsFor(course(from_s), q);
  for (int k = 0; k < settling; ++k) commands_.row(k) = q.transpose();
  for (int k = 0; k < rows; ++k) {
    q = JointsFor(course(from_s + k / kRate_hz), q);
    commands_.row(settling + k) = q.transpose();
  }
  simulation::ArmPlantSettings settings = simulation::PlantOf(arm_, faults_);
  true_arm_ = settings.arm;
  const Eigen::ArrayXd scale = 1.0 + Or(faults_.encoder_scale, n).array();
  const Eigen::MatrixXd of_motor = (commands_.array().rowwise() * scale.transpose()).rowwise() +
                                   Or(faults_.encoder_offset, n).array().transpose();
  const Eigen::VectorXd t_s = Eigen::VectorXd::LinSpaced(
      commands_.rows(), from_s_, from_s_ + double(commands_.rows() - 1) / kRate_hz);
  states_ = simulation::RunArm(settings, t_s, of_motor);
}

std::size_t ArmCarrier::RowAt(double t_s, double& fraction) const {
  const double at = std::clamp((t_s - from_s_) * kRate_hz, 0.0, double(states_.size() - 1));
  const auto row = std::min(std::size_t(at), states_.size() - 2);
  fraction = at - double(row);
  return row;
}

Eigen::VectorXd ArmCarrier::LinksAt(double t_s) const {
  double fraction = 0.0;
  const std::size_t row = RowAt(t_s, fraction);
  return (1.0 - fraction) * states_[row].link + fraction * states_[row + 1].link;
}

Eigen::Vector3d ArmCarrier::WristAt(double t_s) const { return WristOf(true_arm_, LinksAt(t_s)); }

Eigen::VectorXd ArmCarrier::EncodersAt(double t_s) const {
  double fraction = 0.0;
  const std::size_t row = RowAt(t_s, fraction);
  const Eigen::VectorXd motor =
      (1.0 - fraction) * states_[row].motor + fraction * states_[row + 1].motor;
  const int n = arm_.Size();
  return (motor - Or(faults_.encoder_offset, n)).array() /
         (1.0 + Or(faults_.encoder_scale, n).array());
}

void ArmCarrier::Record(Recording& recording, TimeNs start_ns) {
  std::mt19937_64 rng(seed_);
  std::normal_distribution<double> normal;
  JointStream encoders;
  encoders.rate_hz = recording.wrist0->rate_hz;
  for (const ArmJoint& joint : arm_.joints) {
    encoders.types.push_back(joint.type);
    encoders.noise.push_back(joint.type == JointType::kRevolute ? kEncoderNoise_rad
                                                                : kEncoderNoise_m);
  }
  JointStream commands = encoders;
  recording.wrist0->position_noise_m = kWristNoise_m;
  for (auto& sample : recording.wrist0->samples) {
    const double t_s = 1e-9 * double(sample.t_ns - start_ns);
    Eigen::VectorXd q = EncodersAt(t_s);
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] += encoders.noise[std::size_t(i)] * normal(rng);
    sample.value.p_RW = WristOf(arm_, q);
    if (sample.value.q_RW) {  // measured against the last link
      const Eigen::Quaterniond misread(LinkOf(arm_, q) *
                                       LinkOf(true_arm_, LinksAt(t_s)).transpose());
      sample.value.q_RW = (misread * *sample.value.q_RW).normalized();
    }
    encoders.q.push_back({sample.t_ns, q});
    double fraction = 0.0;
    const auto row = Eigen::Index(RowAt(t_s, fraction));
    commands.q.push_back({sample.t_ns, (1.0 - fraction) * commands_.row(row).transpose() +
                                           fraction * commands_.row(row + 1).transpose()});
  }
  recording.arm = arm_;
  recording.joints0 = std::move(encoders);
  recording.joints_command0 = std::move(commands);
  if (!keep_wrist_) recording.wrist0.reset();
}

}  // namespace flextip::hidden
