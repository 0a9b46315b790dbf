#include "reproduction/chapter4/press.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "kinematics/straight.h"
#include "reproduction/chapter4/parts.h"

namespace flextip::reproduction {
namespace {

constexpr double kSteel_kg_m = 0.035;
constexpr double kStation1_m = 0.15, kStation2_m = 0.5;  // 150 mm from the wrist, 100 from the tip
const Eigen::Vector3d kGravity_P(0.0, -9.81, 0.0);
// R has its origin at the tip's place on the block before the shaft sags; Fig. 4.4 has the port at
// (-300, -15) mm from there.
const Eigen::Vector3d kPort(-0.300, -0.015, 0.0);

Instrument SteelRod() {
  Instrument rod = Ch4Rod();
  rod.mass_per_length_kg_m = kSteel_kg_m;
  return rod;
}

Eigen::Vector3d StartWrist() { return -SteelRod().length_m * (-kPort).normalized(); }

simulation::PlantSetup MakePlantSetup(const PressSetup& setup) {
  simulation::PlantSetup plant;
  plant.instrument = SteelRod();
  plant.p_RP = kPort;
  plant.weight_N_m = kSteel_kg_m * kGravity_P;
  plant.gravity_m_s2 = kGravity_P;
  plant.effects.port_friction.coefficient = setup.port_friction;
  return plant;
}

simulation::ArmBody Body(const PressSetup& setup) {
  simulation::ArmBody body;
  body.inertia1_kg_m2 *= setup.inertia_scale;
  body.inertia2_kg_m2 *= setup.inertia_scale;
  body.wrist_mass_kg *= setup.inertia_scale;
  return body;
}

class Press {
 public:
  explicit Press(const PressSetup& setup)
      : setup_(setup),
        plant_(MakePlantSetup(setup), {50, 50}),
        arm_(Body(setup)),
        rng_(setup.seed),
        controller_(setup.kind, {SteelRod(), kPort, kGravity_P, setup.expects_tissue}) {
    shape_ = plant_.Solve(WristAt(state_));
    run_.p_start = shape_.T_RE().p;  // the block is brought up to the tip
    simulation::TipLoad load;
    load.tissue = simulation::Tissue{run_.p_start,     Eigen::Vector3d::UnitY(),
                                     setup.tissue_N_m, setup.tissue_tangential_N_m,
                                     run_.p_start,     1e-3};
    plant_.SetLoad(load);
    shape_ = plant_.Solve(WristAt(state_));
    // At rest, the arm carries what the shaft weighs on it.
    pid_.emplace(setup.pid, -arm_.Jacobian(state_.angles).transpose() * ForceOnArm());
    goal_angles_ = state_.angles;
  }

  PressRun Run() {
    const Eigen::Vector3d down = run_.p_start - setup_.depth_m * Eigen::Vector3d::UnitY();
    const bool reached = Go(down, run_.max_down_m, run_.down_s);
    run_.finished = Go(run_.p_start, run_.max_up_m, run_.up_s) && reached;
    run_.max_m = std::max(run_.max_down_m, run_.max_up_m);
    run_.rms_m = std::sqrt(sum2_ / std::max(1, scored_));
    return std::move(run_);
  }

 private:
  Eigen::Vector3d WristAt(const simulation::ArmState& state) const {
    Eigen::Vector3d p = StartWrist();
    p.head<2>() += arm_.Wrist(state.angles);
    return p;
  }
  Eigen::Vector2d ForceOnArm() const {
    if (!setup_.load_on_arm) return Eigen::Vector2d::Zero();
    return -shape_.f_wrist_N.head<2>();
  }

  /// One way: until the tip is known to be at its goal.
  bool Go(const Eigen::Vector3d& goal, double& largest_m, double& seconds) {
    const int periods = static_cast<int>(setup_.longest_s * setup_.inner_hz);
    double next_update = 0.0;
    for (int period = 0; period < periods && !run_.lost; ++period) {
      if (period >= next_update) {
        next_update += setup_.inner_hz / setup_.outer_hz;
        Score(largest_m);
        if (Update(goal)) return true;
      }
      Advance();
      seconds += 1.0 / setup_.inner_hz;
      t_s_ += 1.0 / setup_.inner_hz;
    }
    return false;
  }

  void Score(double& largest_m) {
    const Eigen::Vector3d p = shape_.T_RE().p;
    const double off = std::abs(p.x() - run_.p_start.x()), up = p.y() - run_.p_start.y();
    largest_m = std::max(largest_m, off);
    run_.overshoot_m = std::max({run_.overshoot_m, up, -up - setup_.depth_m});
    sum2_ += off * off;
    ++scored_;
    run_.p_RE.push_back(p);
    run_.t_s.push_back(t_s_);
    run_.peak_force_N = std::max(run_.peak_force_N, shape_.f_tip_N.norm());
    const StraightShaft straight = SolveStraight(WristAt(state_), kPort, SteelRod().length_m);
    run_.peak_flexion_m = std::max(run_.peak_flexion_m, (p - straight.p_tip).norm());
  }

  Measurements Sense() {
    const Ch4Shape shape{shape_.T_RW().p, shape_.T_RE().p, shape_.Tangent(0.0), shape_.t_port,
                         shape_.Tangent(shape_.length_m)};
    const Ch4Noise noise{false, setup_.position_noise_m, setup_.angle_noise_rad, true, 1};
    Measurements z = Ch4Sense(shape, noise, rng_);
    if (!setup_.strain) return z;
    z.port_direction.reset();
    std::normal_distribution<double> moment(0.0, setup_.moment_noise_Nm);
    StrainMeasurement strain;
    const double m1 = shape_.Moment(kStation1_m).z(), m2 = shape_.Moment(kStation2_m).z();
    strain.moments_Nm << 0.0, m1 + moment(rng_), 0.0, m2 + moment(rng_);
    strain.station_from_wrist_m[0] = kStation1_m;
    strain.station_from_wrist_m[1] = kStation2_m;
    strain.moment_noise_Nm = setup_.moment_noise_Nm;
    z.strain = strain;
    return z;
  }

  /// The outer loop. True where the tip is known to be at the goal.
  bool Update(const Eigen::Vector3d& goal) {
    const Ch4Step step = controller_.Step(Sense(), goal);
    run_.straight_instead += step.straight_instead;
    const Eigen::Vector2d wrist = step.wrist_step.head<2>();
    goal_angles_ = state_.angles + arm_.Jacobian(state_.angles).inverse() * wrist;  // (3.4)
    return (step.p_RE_known - goal).norm() < setup_.reached_m;
  }

  /// The inner loop.
  void Advance() {
    constexpr int kSubsteps = 5;
    const double period_s = 1.0 / setup_.inner_hz;
    const Eigen::Vector2d torque =
        pid_->Torque(goal_angles_ - state_.angles, state_.rates, period_s);
    for (int i = 0; i < kSubsteps; ++i) {
      arm_.Step(state_, torque, ForceOnArm(), period_s / kSubsteps);
    }
    simulation::PlantShape next = plant_.Solve(WristAt(state_), t_s_);
    run_.lost = !next.IsUsable();
    if (!run_.lost) shape_ = std::move(next);
  }

  const PressSetup setup_;
  simulation::Plant plant_;
  simulation::DynamicArm arm_;
  simulation::ArmState state_;
  std::mt19937_64 rng_;
  Ch4Controller controller_;
  std::optional<simulation::JointPid> pid_;
  Eigen::Vector2d goal_angles_;
  simulation::PlantShape shape_;
  PressRun run_;
  double t_s_ = 0.0, sum2_ = 0.0;
  int scored_ = 0;
};

}  // namespace

PressRun RunPress(const PressSetup& setup) { return Press(setup).Run(); }

}  // namespace flextip::reproduction
