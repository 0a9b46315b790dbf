#include "reproduction/chapter4/steps.h"

#include <algorithm>
#include <cmath>

namespace flextip::reproduction {
namespace {

Eigen::Vector3d Direction(double angle) { return {std::cos(angle), std::sin(angle), 0.0}; }

/// An orientation with its x axis along the shaft, turned about z by `turn`.
Eigen::Matrix3d Frame(const Eigen::Vector3d& t, double turn) {
  return Eigen::AngleAxisd(std::atan2(t.y(), t.x()) + turn, Eigen::Vector3d::UnitZ())
      .toRotationMatrix();
}

double FromPath(const Eigen::Vector3d& p, const Eigen::Vector3d& start,
                const Eigen::Vector3d& move) {
  const double t = std::clamp((p - start).dot(move) / move.squaredNorm(), 0.0, 1.0);
  return (p - start - t * move).norm();
}

/// The mean of `samples` draws.
class Draw {
 public:
  Draw(const Ch4Noise& noise, std::mt19937_64& rng) : noise_(noise), rng_(rng) {}
  double operator()(double size) {
    double sum = 0.0;
    for (int i = 0; i < noise_.samples; ++i) sum += noise_.uniform ? uniform_(rng_) : normal_(rng_);
    return size * sum / noise_.samples;
  }
  /// Standard deviation of what comes out.
  double Sd(double size) const {
    return size * (noise_.uniform ? 1.0 / std::sqrt(3.0) : 1.0) / std::sqrt(noise_.samples);
  }

 private:
  const Ch4Noise& noise_;
  std::mt19937_64& rng_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
  std::normal_distribution<double> normal_;
};

}  // namespace

Ch4Plant Ch4Plant::Beam(const Instrument& instrument, const Eigen::Vector3d& p_RP, double f_tip_N) {
  PlaneBeamProblem problem;
  problem.p_port = p_RP.head<2>();
  problem.length_m = instrument.length_m;
  problem.load_over_EI = f_tip_N / instrument.bending_stiffness_Nm2;
  return Ch4Plant(problem);
}

std::optional<Ch4Shape> Ch4Plant::At(const Eigen::Vector3d& p_RW) {
  if (exact_) {
    const simulation::PlantShape shape = exact_->Solve(p_RW);
    if (!shape.IsUsable()) return std::nullopt;
    const Eigen::Vector3d t_end = shape.Tangent(shape.length_m);
    return Ch4Shape{p_RW, shape.T_RE().p + overhang_m_ * t_end, shape.Tangent(0.0), shape.t_port,
                    t_end};
  }
  beam_.p_wrist = p_RW.head<2>();
  const PlaneBeam beam = SolvePlaneBeam(beam_);
  if (!beam.IsUsable()) return std::nullopt;
  const double length = beam_.length_m;
  const auto direction = [&](double x) {
    return Direction(beam.phi + std::atan(BeamSlope(beam.F_p_over_EI, beam.a, length, x)));
  };
  Ch4Shape shape{p_RW, Eigen::Vector3d::Zero(), direction(0.0), direction(beam.a),
                 direction(length)};
  shape.p_RE.head<2>() = beam.p_tip;
  return shape;
}

Measurements Ch4Sense(const Ch4Shape& shape, const Ch4Noise& noise, std::mt19937_64& rng) {
  Draw draw(noise, rng);
  const auto position = [&] {
    const double x = draw(noise.position_m);
    return Eigen::Vector3d(x, draw(noise.position_m), 0.0);
  };
  Measurements z;
  z.p_RW = shape.p_RW + position();
  z.wrist_position_noise_m = draw.Sd(noise.position_m);
  z.R_RW = Frame(shape.t_wrist, draw(noise.angle_rad));
  z.wrist_orientation_noise_rad = draw.Sd(noise.angle_rad);
  z.em = EmMeasurement{};
  z.em->T_RS.p = shape.p_RE + position();
  z.em->T_RS.R = Frame(shape.t_tip, draw(noise.angle_rad));
  z.em->position_noise_m = draw.Sd(noise.position_m);
  z.em->orientation_noise_rad = draw.Sd(noise.angle_rad);
  z.port_direction = Frame(shape.t_port, draw(noise.angle_rad)).col(0);
  z.port_direction_noise_rad = draw.Sd(noise.angle_rad);
  return z;
}

Ch4Run RunCh4Move(const Ch4Move& move, Ch4Plant plant) {
  Ch4Run run;
  std::mt19937_64 rng(move.seed);
  Ch4Controller controller(move.kind, move.setup);
  std::optional<Ch4Shape> shape = plant.At(move.p_RW_start);
  if (!shape) {
    run.lost = true;
    return run;
  }
  const Eigen::Vector3d start = shape->p_RE, end = start + move.move_m;
  run.p_RE.push_back(start);
  for (bool reached = false; !reached && run.updates < move.most_updates;) {
    ++run.updates;
    const double travelled = std::min(run.updates * move.step_m, move.move_m.norm());
    const Measurements z = Ch4Sense(*shape, move.noise, rng);
    // Where the noise is only in the model, the tip's error is the true one.
    const std::optional<Eigen::Vector3d> seen =
        move.noise.tip_too ? std::nullopt : std::optional(shape->p_RE);
    const Ch4Step step = controller.Step(z, start + travelled * move.move_m.normalized(), seen);
    const Eigen::Vector3d& known = step.p_RE_known;
    run.p_RE_measured.push_back(known);
    run.max_measured_m = std::max(run.max_measured_m, FromPath(known, start, move.move_m));
    // The stop comes before the motion: the tip is where it should be.
    reached = travelled >= move.move_m.norm() && (known - end).norm() < move.reached_m;
    if (reached) break;
    shape = plant.At(shape->p_RW + step.wrist_step);
    if (!shape) {
      run.lost = true;
      break;
    }
    run.p_RE.push_back(shape->p_RE);
    run.max_m = std::max(run.max_m, FromPath(shape->p_RE, start, move.move_m));
  }
  return run;
}

}  // namespace flextip::reproduction
