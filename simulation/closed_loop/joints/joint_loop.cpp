#include "simulation/closed_loop/joints/joint_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace flextip::simulation {
namespace {

constexpr int kWaves = 3;
constexpr double kBegins_s = 1.0;

struct Wave {
  double size, speed, phase;
};

/// Commands as they were given, for a plant that gets them late.
class Given {
 public:
  Given(double step_s, const Eigen::VectorXd& first) : step_s_(step_s), commands_{first} {}
  void Add(const Eigen::VectorXd& command) { commands_.push_back(command); }
  /// The command that stood at a time; the first before all.
  const Eigen::VectorXd& At(double t_s) const {
    const double row = std::floor(t_s / step_s_ + 1e-6) + 1.0;
    return commands_[std::size_t(std::clamp(row, 0.0, double(commands_.size() - 1)))];
  }

 private:
  double step_s_;
  std::vector<Eigen::VectorXd> commands_;
};

class Score {
 public:
  explicit Score(const JointLoopSetup& setup)
      : chain_(setup.plant.arm), T_LK_(setup.T_LK), squares_(Eigen::VectorXd::Zero(chain_.Size())) {
    result_.max = squares_;
  }
  void Add(const Eigen::VectorXd& truth, const Eigen::VectorXd& wish) {
    const Eigen::VectorXd off = truth - wish;
    squares_ += off.cwiseAbs2();
    result_.max = result_.max.cwiseMax(off.cwiseAbs());
    const double tip_m = (Tip(truth) - Tip(wish)).norm();
    tip_squares_ += tip_m * tip_m;
    result_.tip_max_m = std::max(result_.tip_max_m, tip_m);
    ++result_.cycles;
  }
  JointLoopResult Result() {
    const double count = std::max(1, result_.cycles);
    result_.rms = (squares_ / count).cwiseSqrt();
    result_.tip_rms_m = std::sqrt(tip_squares_ / count);
    return result_;
  }
  JointLoopResult& Counts() { return result_; }

 private:
  Eigen::Vector3d Tip(const Eigen::VectorXd& q) const {
    return (chain_.Frame(q, chain_.Size() - 1) * T_LK_.p.homogeneous()).head<3>();
  }

  ChainOfLinks chain_;
  Pose T_LK_;
  JointLoopResult result_;
  Eigen::VectorXd squares_;
  double tip_squares_ = 0.0;
};

JointWish WishOf(const JointMotion& motion, double t_s, const JointFeedForward& feed_forward) {
  JointWish wish = motion(t_s + feed_forward.Lead_s());
  wish.v_ahead.resize(feed_forward.Size());
  for (int j = 0; j < feed_forward.Size(); ++j)
    wish.v_ahead[j] = motion(t_s + feed_forward.Lead_s() + feed_forward.TurnAhead_s()[j]).v[j];
  return wish;
}

}  // namespace

JointMotion MotionOf(const SineMotion& sines) {
  std::mt19937_64 rng(sines.seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<std::vector<Wave>> waves;
  for (Eigen::Index i = 0; i < sines.centre.size(); ++i) {
    std::vector<Wave> own;
    for (int w = 0; w < kWaves; ++w) {
      const double hz = sines.fastest_hz * (0.3 + 0.7 * unit(rng)), phase = unit(rng);
      own.push_back(
          {sines.size[i] / kWaves, 2.0 * std::numbers::pi * hz, 2.0 * std::numbers::pi * phase});
    }
    waves.push_back(own);
  }
  return [centre = sines.centre, waves](double t_s) {
    const auto n = centre.size();
    JointWish wish{centre, JointVector::Zero(n), JointVector::Zero(n), {}};
    const double u = std::clamp(t_s / kBegins_s, 0.0, 1.0);
    // Five times differentiable at both ends, or efforts would jump.
    const double b = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
    const double bv = 30.0 * u * u * (1.0 - u) * (1.0 - u) / kBegins_s;
    const double ba = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (kBegins_s * kBegins_s);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (const Wave& wave : waves[std::size_t(i)]) {
        const double s = wave.size * std::sin(wave.speed * t_s + wave.phase),
                     c = wave.size * std::cos(wave.speed * t_s + wave.phase);
        wish.q[i] += b * s;
        wish.v[i] += bv * s + b * wave.speed * c;
        wish.a[i] += ba * s + 2.0 * bv * wave.speed * c - b * wave.speed * wave.speed * s;
      }
    }
    return wish;
  };
}

JointLoopResult RunJointLoop(const JointLoopSetup& setup) {
  const int n = setup.plant.arm.Size();
  const auto or_zero = [&](const Eigen::VectorXd& list) {
    return list.size() > 0 ? list : Eigen::VectorXd(Eigen::VectorXd::Zero(n));
  };
  const Eigen::VectorXd offset = or_zero(setup.encoder_offset),
                        scale = or_zero(setup.encoder_scale);
  // The servo knows its motor by the encoder alone.
  const auto of_motor = [&](const JointVector& command) {
    return Eigen::VectorXd(command.array() * (1.0 + scale.array()) + offset.array());
  };
  const double step_s = 1.0 / setup.rate_hz;
  const JointWish start = setup.motion(0.0);
  std::optional<JointFeedForward> feed_forward;
  JointVector command = start.q;
  if (setup.model) {
    feed_forward.emplace(*setup.model, setup.options, start.q);
    JointWish rest = start;  // the arm had time to come to where it starts
    rest.v = rest.a = JointVector::Zero(n);
    command = feed_forward->Step(rest, 0.9).q;
  }
  ArmPlant plant(setup.plant, of_motor(command));
  Given given(step_s, of_motor(command));
  Score score(setup);
  const auto cycles = int(setup.seconds * setup.rate_hz);
  for (int k = 0; k < cycles; ++k) {
    const double t_s = k * step_s;
    const JointWish now = setup.motion(t_s);
    if (t_s >= setup.judged_from_s) score.Add(plant.State().link, now.q);
    command = now.q;
    if (feed_forward) {
      JointVector effort;
      if (setup.measured_effort) effort = plant.State().effort;
      const JointCommand next =
          feed_forward->Step(WishOf(setup.motion, t_s, *feed_forward), step_s, effort);
      command = next.q;
      score.Counts().rate_limited += next.rate_limited;
      score.Counts().correction_limited += next.correction_limited;
    }
    given.Add(of_motor(command));
    plant.AdvanceTo(t_s + step_s, [&](double t) -> Eigen::VectorXd { return given.At(t); });
  }
  return score.Result();
}

}  // namespace flextip::simulation
