#include "reproduction/chapter4/controllers.h"

#include <cmath>
#include <optional>

#include "control/controller.h"
#include "estimation/moment_fit.h"
#include "estimation/shaft_estimator.h"
#include "estimation/three_slope_fit.h"
#include "kinematics/plane_beam.h"
#include "kinematics/straight.h"
#include "reproduction/printed_jacobian.h"

namespace flextip::reproduction {
namespace {

constexpr double kMaxStep_m = 0.05;

BeamFit FitBeam(const Measurements& z, const Ch4Setup& setup) {
  const Eigen::Vector3d p_RE = z.em->T_RS.p;
  const double length = setup.instrument.length_m;
  if (z.strain)
    return FitFromMoments(z.p_RW, p_RE, MomentsInR(*z.strain, *z.R_RW),
                          setup.instrument.bending_stiffness_Nm2, length);
  SlopeNoise noise;
  noise.wrist_rad = z.wrist_orientation_noise_rad;
  noise.port_rad = z.port_direction_noise_rad;
  noise.tip_rad = z.em->orientation_noise_rad;
  noise.chord_rad = std::hypot(z.wrist_position_noise_m, z.em->position_noise_m) / length;
  return FitFromThreeSlopes(z.p_RW, p_RE, z.R_RW->col(0), *z.port_direction, z.em->T_RS.R.col(0),
                            length, noise)
      .beam;
}

/// The beam's Jacobian in the x-y plane, by the kind's formula.
Eigen::Matrix2d BeamJacobianOf(Ch4Kind kind, const BeamFit& fit) {
  if (kind == Ch4Kind::kPortForce || kind == Ch4Kind::kTipForce) {
    const BeamLoadLaw law =
        kind == Ch4Kind::kPortForce ? BeamLoadLaw::kPortForce : BeamLoadLaw::kTipForce;
    return BeamJacobian(fit, law).topLeftCorner<2, 2>();
  }
  // The printed form wants y_M on the left of x_M, as in the plane's own frame.
  const double side = fit.R_RM(2, 2) > 0.0 ? 1.0 : -1.0;
  const double y_a = side * BeamPortHeight(fit.F_p_over_EI, fit.a, fit.length_m);
  const double chord = std::atan2(fit.R_RM(1, 0), fit.R_RM(0, 0));  // (3.9)
  const double line = chord + std::atan(y_a / fit.a);
  const Eigen::Vector2d to_port =
      std::hypot(fit.a, y_a) * Eigen::Vector2d(std::cos(line), std::sin(line));  // (3.8)
  return PrintedPlaneJacobian(fit.a, y_a, fit.length_m,
                              kind == Ch4Kind::kPrintedWithLine ? line : chord, to_port);
}

std::optional<Eigen::Matrix2d> StraightJacobian(const Measurements& z, const Ch4Setup& setup) {
  const StraightShaft shaft = SolveStraight(z.p_RW, setup.p_RP, setup.instrument.length_m);
  if (!shaft.IsUsable()) return std::nullopt;
  return shaft.J_tip_wrist.topLeftCorner<2, 2>();
}

EstimatorOptions Options(const Ch4Setup& setup) {
  EstimatorOptions options = EstimatorOptionsFor(setup.instrument, setup.p_RP, setup.gravity_m_s2);
  options.estimate_tissue = setup.tissue;
  return options;
}

/// Noise seldom makes the squared residuals of n measurements larger than this.
bool Believable(const ShaftEstimate& estimate) {
  const double n = estimate.measurements;
  return estimate.status == EstimateStatus::kOk && estimate.chi2 < n + 4.0 * std::sqrt(2.0 * n);
}

ControllerOptions RodOptions() {
  ControllerOptions options;
  options.kind = ControllerKind::kRodTrack;
  options.max_step_m = kMaxStep_m;
  return options;
}

}  // namespace

const char* Name(Ch4Kind kind) {
  switch (kind) {
    case Ch4Kind::kStraight:
      return "straight";
    case Ch4Kind::kPrinted:
      return "flexion as printed";
    case Ch4Kind::kPrintedWithLine:
      return "flexion as printed, phi repaired";
    case Ch4Kind::kPortForce:
      return "flexion corrected, F_p constant";
    case Ch4Kind::kTipForce:
      return "flexion corrected, F_t constant";
    case Ch4Kind::kRod:
      return "rod";
  }
  return "";
}

struct Ch4Controller::Impl {
  Ch4Kind kind;
  Ch4Setup setup;
  ShaftEstimator estimator;
  TipController rod;
  bool started = false;

  /// The estimator's fit starts from the last one; from the unloaded shaft, or after an outlier, it
  /// may end far off. Then it is led to the beam's load first.
  ShaftEstimate FromTheBeam(const Measurements& z) {
    const BeamFit fit = FitBeam(z, setup);
    estimator.Reset();
    if (fit.IsUsable()) {
      Measurements led = z;
      led.load = LoadMeasurement{BeamTipLoad(fit) * setup.instrument.bending_stiffness_Nm2, 0.1};
      estimator.Update(led);
    }
    ShaftEstimate estimate = estimator.Update(z);
    for (int i = 0; i < 4 && !Believable(estimate); ++i) estimate = estimator.Update(z);
    return estimate;
  }

  Ch4Step RodStep(const Measurements& z, const Eigen::Vector3d& p_RE_desired,
                  const std::optional<Eigen::Vector3d>& p_RE) {
    ShaftEstimate estimate = started ? estimator.Update(z) : FromTheBeam(z);
    if (!Believable(estimate)) estimate = FromTheBeam(z);
    started = true;
    if (!Believable(estimate)) return PlaneStep(Ch4Kind::kTipForce, z, p_RE_desired, p_RE);
    ControlInput input;
    input.p_RW = z.p_RW;
    input.model = estimate.model;
    input.tip_measured = true;
    input.p_RE_measured = estimate.p_RE;
    if (p_RE) input.p_RE_measured = *p_RE;
    input.p_RE_desired = p_RE_desired;
    const ControlOutput output = rod.Step(input);
    return {output.p_RW_command - z.p_RW, input.p_RE_measured, output.status != ControlStatus::kOk};
  }

  Ch4Step PlaneStep(Ch4Kind by, const Measurements& z, const Eigen::Vector3d& p_RE_desired,
                    const std::optional<Eigen::Vector3d>& p_RE) const {
    Ch4Step step;
    step.p_RE_known = p_RE.value_or(z.em->T_RS.p);
    std::optional<Eigen::Matrix2d> J;
    if (by != Ch4Kind::kStraight) {
      const BeamFit fit = FitBeam(z, setup);
      if (fit.IsUsable()) J = BeamJacobianOf(by, fit);
      step.straight_instead = !J;
    }
    if (!J) J = StraightJacobian(z, setup);
    if (!J) return step;
    const Eigen::Vector2d wrist = J->inverse() * (p_RE_desired - step.p_RE_known).head<2>();
    const double size = wrist.norm();
    step.wrist_step.head<2>() =
        size > kMaxStep_m ? Eigen::Vector2d(kMaxStep_m / size * wrist) : wrist;
    return step;
  }
};

Ch4Controller::Ch4Controller(Ch4Kind kind, const Ch4Setup& setup)
    : impl_(new Impl{kind, setup, ShaftEstimator(Options(setup)), TipController(RodOptions())}) {}
Ch4Controller::Ch4Controller(Ch4Controller&&) noexcept = default;
Ch4Controller& Ch4Controller::operator=(Ch4Controller&&) noexcept = default;
Ch4Controller::~Ch4Controller() = default;

Ch4Step Ch4Controller::Step(const Measurements& z, const Eigen::Vector3d& p_RE_desired,
                            const std::optional<Eigen::Vector3d>& p_RE) {
  return impl_->kind == Ch4Kind::kRod ? impl_->RodStep(z, p_RE_desired, p_RE)
                                      : impl_->PlaneStep(impl_->kind, z, p_RE_desired, p_RE);
}

}  // namespace flextip::reproduction
