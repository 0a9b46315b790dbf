#include "simulation/joints/arm_recording.h"

#include <cmath>
#include <numbers>
#include <random>

namespace flextip::simulation {
namespace {

constexpr double kEncoderNoise_rad = 2e-5, kEncoderNoise_m = 5e-6;
constexpr double kSeenNoise_rad = 3e-4, kSeenNoise_m = 5e-5;
constexpr double kEffortNoise_Nm = 0.01, kEffortNoise_N = 0.05;
constexpr double kPoseNoise_m = 1e-4, kPoseNoise_rad = 1e-3;
constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000;

bool Turns(const Arm& arm, Eigen::Index i) { return arm.joints[i].type == JointType::kRevolute; }

Eigen::MatrixXd MotionOf(const Arm& arm, const ArmMotion& motion, const Eigen::VectorXd& t_s) {
  constexpr int kWaves = 3;
  std::mt19937_64 rng(motion.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  // From rest: a jerk at the start would ring in all efforts.
  const Eigen::ArrayXd u = (t_s.array() - t_s[0]).min(1.0), begins = u * u * (3.0 - 2.0 * u);
  Eigen::MatrixXd commands(t_s.size(), arm.Size());
  for (Eigen::Index i = 0; i < arm.Size(); ++i) {
    const double size = Turns(arm, i) ? motion.size_rad : motion.size_m;
    commands.col(i).setConstant(Turns(arm, i) ? 0.2 : 0.1);
    for (int wave = 0; wave < kWaves; ++wave) {
      const double hz = motion.fastest_hz * (0.3 + 0.7 * unit(rng));
      const double phase = 2.0 * std::numbers::pi * unit(rng);
      const double part = 0.6 + 0.4 * unit(rng);
      commands.col(i).array() +=
          size * part * begins * (2.0 * std::numbers::pi * hz * t_s.array() + phase).sin();
    }
  }
  return commands;
}

/// A list, or so many times `fallback`.
Eigen::VectorXd Or(const Eigen::VectorXd& list, double fallback, int size) {
  return list.size() > 0 ? list : Eigen::VectorXd(Eigen::VectorXd::Constant(size, fallback));
}

class Recorder {
 public:
  Recorder(const Arm& arm, const ArmMotion& motion)
      : arm_(arm), motion_(motion), rng_(motion.seed + 77) {}

  JointStream Joints(double noise_rad, double noise_m) const {
    JointStream stream;
    stream.rate_hz = motion_.rate_hz;
    for (const ArmJoint& joint : arm_.joints) {
      stream.types.push_back(joint.type);
      stream.noise.push_back(joint.type == JointType::kRevolute ? noise_rad : noise_m);
    }
    return stream;
  }

  Eigen::VectorXd Noisy(Eigen::VectorXd values, const std::vector<double>& noise) {
    for (Eigen::Index i = 0; i < values.size(); ++i) values[i] += noise[i] * normal_(rng_);
    return values;
  }
  Eigen::Vector3d Noise(double sd) {
    return {sd * normal_(rng_), sd * normal_(rng_), sd * normal_(rng_)};
  }

 private:
  const Arm& arm_;
  const ArmMotion& motion_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
};

TimeNs StampOf(double t_s) { return kStart_ns + TimeNs(std::llround(1e9 * t_s)); }

}  // namespace

JointDrive StiffDrive(bool turns) {
  const double unit = turns ? 1.0 : 100.0;
  JointDrive drive;
  drive.servo_stiffness = 1e4 * unit;
  drive.cable_stiffness = 4e4 * unit;
  if (!turns) drive.motor_inertia *= 50.0;
  return drive;
}

double StiffnessOf(double compliance, double own) {
  return compliance > 1.0 / own ? 1.0 / compliance : own;
}

ArmPlantSettings PlantOf(const Arm& arm, const ArmFaults& faults) {
  ArmPlantSettings settings{.arm = arm, .drives = {}, .masses = {}, .routing = faults.routing};
  const int n = arm.Size();
  for (int i = 0; i < n && faults.a_change_m.size() > 0; ++i) {
    settings.arm.joints[i].a_m += faults.a_change_m[i];
    PlaceJoint(arm.convention, settings.arm.joints[i]);
  }
  const Eigen::VectorXd play = Or(faults.play, 0.0, n), coulomb = Or(faults.motor_coulomb, 0.0, n),
                        viscous = Or(faults.motor_viscous, 0.0, n);
  for (int i = 0; i < n; ++i) {
    JointDrive drive = StiffDrive(Turns(arm, i));
    if (faults.servo_stiffness.size() > 0) drive.servo_stiffness = faults.servo_stiffness[i];
    drive.servo_damping =
        faults.servo_damping.size() > 0 ? faults.servo_damping[i] : 1e-3 * drive.servo_stiffness;
    if (faults.cable_stiffness.size() > 0) drive.cable_stiffness = faults.cable_stiffness[i];
    drive.cable_damping = 2e-4 * drive.cable_stiffness;
    drive.play = play[i];
    drive.motor_coulomb = coulomb[i];
    drive.motor_viscous = viscous[i];
    drive.link_coulomb = play[i] > 0.0 ? 0.5 : 0.0;  // what lets a link stay in its play
    settings.drives.push_back(drive);
  }
  for (int i = 0; i < int(arm.links.size()); ++i)
    settings.masses.push_back({i, arm.links[i].mass_kg, arm.links[i].com_m});
  settings.masses.insert(settings.masses.end(), faults.payload.begin(), faults.payload.end());
  settings.command_delay_s = faults.command_delay_s;
  settings.servo_holds_gravity = faults.servo_holds_gravity;
  if (faults.play.size() > 0) settings.gravity_m_s2.setZero();
  return settings;
}

Arm SmallArm() {
  constexpr double right = std::numbers::pi / 2;
  Arm arm;
  const auto add = [&](JointType type, double a, double alpha, double d, double theta,
                       const ArmLink& link) {
    ArmJoint joint;
    joint.type = type;
    joint.a_m = a;
    joint.alpha_rad = alpha;
    joint.d_m = d;
    joint.theta_rad = theta;
    PlaceJoint(arm.convention, joint);
    arm.joints.push_back(joint);
    arm.links.push_back(link);
  };
  add(JointType::kRevolute, 0.0, right, 0.1, 0.0, {1.5, {0.1, 0.05, 0.0}});
  add(JointType::kRevolute, 0.25, -right, 0.0, 0.3, {0.9, {0.12, 0.0, 0.03}});
  add(JointType::kPrismatic, 0.2, right, 0.05, 0.0, {0.5, {0.02, 0.01, -0.05}});
  arm.T_LK = Pose{Eigen::Matrix3d::Identity(), {0.05, 0.0, 0.1}};
  arm.payload_places = {{"elbow", 2, {0.2, 0.0, 0.0}}, {"slide", 3, {0.05, 0.0, 0.1}}};
  return arm;
}

Recording RecordArm(const Arm& arm, const ArmFaults& faults, const ArmSensors& sensors,
                    const ArmMotion& motion) {
  const auto rows = Eigen::Index(motion.seconds * motion.rate_hz);
  const Eigen::VectorXd t_s =
      Eigen::VectorXd::LinSpaced(rows, 0.0, double(rows - 1) / motion.rate_hz);
  const Eigen::MatrixXd commands = MotionOf(arm, motion, t_s);
  const ArmPlantSettings settings = PlantOf(arm, faults);
  const int n = arm.Size();
  const Eigen::VectorXd offset = Or(faults.encoder_offset, 0.0, n),
                        scale = Or(faults.encoder_scale, 0.0, n);
  // The servo knows the motor by its encoder alone.
  const Eigen::MatrixXd of_motor =
      (commands.array().rowwise() * (1.0 + scale.array()).transpose()).rowwise() +
      offset.array().transpose();
  const auto states = RunArm(settings, t_s, of_motor);
  const ChainOfLinks chain(settings.arm);
  Recording recording;
  recording.has_shaft = false;
  recording.arm = arm;
  Recorder recorder(arm, motion);
  JointStream command = recorder.Joints(0.0, 0.0),
              encoders = recorder.Joints(kEncoderNoise_rad, kEncoderNoise_m),
              seen = recorder.Joints(kSeenNoise_rad, kSeenNoise_m);
  TorqueStream torque;
  torque.rate_hz = motion.rate_hz;
  torque.types = command.types;
  for (int i = 0; i < n; ++i)
    torque.noise.push_back(Turns(arm, i) ? kEffortNoise_Nm : kEffortNoise_N);
  PoseStream pose;
  pose.rate_hz = motion.rate_hz;
  pose.position_noise_m = kPoseNoise_m;
  pose.orientation_noise_rad = kPoseNoise_rad;
  const Pose T_LK = arm.T_LK.value_or(Pose{});
  for (Eigen::Index k = 0; k < rows; ++k) {
    const TimeNs t_ns = StampOf(t_s[k]);
    const ArmPlantState& state = states[std::size_t(k)];
    command.q.push_back({t_ns, commands.row(k).transpose()});
    const Eigen::VectorXd encoder = (state.motor - offset).array() / (1.0 + scale.array());
    encoders.q.push_back({t_ns, recorder.Noisy(encoder, encoders.noise)});
    seen.q.push_back({t_ns, recorder.Noisy(state.link, seen.noise)});
    torque.tau.push_back({t_ns, recorder.Noisy(state.effort, torque.noise)});
    const Pose T_RK =
        Pose::FromMatrix(chain.Frame(state.link, n - 1)) * Pose{T_LK.R, T_LK.p + faults.marker_m};
    const Eigen::Vector3d turn = recorder.Noise(kPoseNoise_rad);
    const Eigen::Quaterniond shaken(1.0, turn.x() / 2, turn.y() / 2, turn.z() / 2);
    pose.samples.push_back({t_ns,
                            {T_RK.p + faults.tracker_m + recorder.Noise(kPoseNoise_m),
                             (shaken.normalized() * T_RK.Quaternion()).normalized()}});
  }
  if (sensors.command) recording.joints_command0 = command;
  if (sensors.encoders) recording.joints0 = encoders;
  if (sensors.seen) recording.joints_seen0 = seen;
  if (sensors.torque) recording.torque0 = torque;
  if (sensors.pose) recording.pose0 = pose;
  return recording;
}

}  // namespace flextip::simulation
