#include "control/controller.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "control/wrist_step.h"
#include "core/linear_algebra.h"
#include "core/place.h"
#include "kinematics/straight.h"

namespace flextip {
namespace {

constexpr std::array<const char*, kControllerKinds> kNames = {
    "straight-calculate", "straight-track", "flex-calculate",
    "flex-track",         "rod-calculate",  "rod-track"};

constexpr double kMostSingular = 1e3;  // bound on a Jacobian's singular value that damps it

/// What a kinematic model says of the instrument now.
struct Prediction {
  ControlStatus status = ControlStatus::kNoModel;
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();
  Eigen::Matrix3d J_tip_wrist = Eigen::Matrix3d::Zero();
};

Prediction PredictStraight(const ControlInput& input) {
  const StraightShaft shaft =
      SolveStraight(input.p_RW, input.model.p_RP, input.model.instrument.length_m);
  if (!shaft.IsUsable()) return {};
  return {ControlStatus::kOk, shaft.p_tip, shaft.J_tip_wrist};
}

Prediction StraightInstead(const ControlInput& input) {
  Prediction prediction = PredictStraight(input);
  if (prediction.status == ControlStatus::kOk) prediction.status = ControlStatus::kStraightInstead;
  return prediction;
}

Prediction PredictFlex(const ControlInput& input, BeamLoadLaw law) {
  const BeamFit& beam = input.model.beam;
  if (!beam.IsUsable()) return StraightInstead(input);
  return {ControlStatus::kOk, BeamTip(beam, input.p_RW), BeamJacobian(beam, law)};
}

/// The wrist that moves the tip is the measured one: where the arm yields, the rod's derivative by
/// it says so; where it has play, the shaft follows the true wrist beside it.
Prediction PredictRod(const ControlInput& input, const ControllerOptions& options,
                      ShaftRod& solver) {
  const ShaftModel& model = input.model;
  const ShaftRodState rod = solver.Solve(RodOf(model, input.p_RW));
  if (!rod.IsUsable() || !rod.dp_RE.allFinite()) return StraightInstead(input);
  // dp = J dw + C df with df = K dp.
  const Eigen::Matrix3d C = rod.dp_RE.rightCols<3>();
  const Eigen::Matrix3d K =
      TrustedStiffness(model.tissue_stiffness_N_m, C, options.max_tissue_gain);
  return {model.force_known ? ControlStatus::kOk : ControlStatus::kStraightInstead, rod.p_RE,
          (Eigen::Matrix3d::Identity() - C * K).inverse() * rod.dp_RE.leftCols<3>()};
}

Prediction Predict(const ControlInput& input, const ControllerOptions& options, ShaftRod& solver) {
  switch (options.kind) {
    case ControllerKind::kStraightCalculate:
    case ControllerKind::kStraightTrack:
      return PredictStraight(input);
    case ControllerKind::kFlexCalculate:
    case ControllerKind::kFlexTrack:
      return PredictFlex(input, options.beam_load_law);
    case ControllerKind::kRodCalculate:
    case ControllerKind::kRodTrack:
      return PredictRod(input, options, solver);
  }
  return {};
}

/// J^-1 dx, damped where the smallest singular value falls below `options.min_singular_value`
/// (Nakamura and Hanafusa 1986): the damping grows from nothing at that bound.
Eigen::Vector3d SolveDamped(const Eigen::Vector3d& dx, const ControllerOptions& options,
                            ControlOutput& output) {
  const Svd svd(output.J_tip_wrist);
  const Eigen::Vector3d& sigma = svd.sigma;
  output.smallest_singular_value = sigma[2];
  const double bound = options.min_singular_value;
  const double missing = 1.0 - std::min(1.0, sigma[2] / bound);
  const double damping2 = missing * bound * bound;
  output.damped = damping2 > 0.0;
  const Eigen::Vector3d inverse = sigma.array() / (sigma.array().square() + damping2);
  return svd.V * inverse.cwiseProduct(svd.U.transpose() * dx);
}

/// The command goes on from the last one: with the goal's motion at once, and to the command that
/// corrects the tip wholly, `p_whole`, by a part. What noise does to that one from cycle to cycle
/// is left out by that part. The loop's gain falls by it, no lag behind the goal comes in.
Eigen::Vector3d GoOn(const SentCommand& last, const ControlInput& input,
                     const ControllerOptions& options, const Eigen::Vector3d& p_whole,
                     ControlOutput& output) {
  const Eigen::Vector3d way = input.p_RE_desired - last.p_RE_desired;
  const Eigen::Vector3d p_on = last.p_RW + SolveDamped(way, options, output);
  return p_on + CorrectionPart(options) * (p_whole - p_on);
}

bool IsPlausible(const ControllerOptions& o) {
  return std::isfinite(o.gain) && o.max_step_m >= 0.0 && o.max_step_m <= kFarthestPlace_m &&
         o.max_tissue_gain >= 1.0 && std::isfinite(o.max_tissue_gain) &&
         o.min_singular_value > 0.0 && o.min_singular_value <= kMostSingular &&
         std::isfinite(o.correction_s) && std::isfinite(o.rate_hz);
}

bool UsesRod(ControllerKind kind) {
  return kind == ControllerKind::kRodCalculate || kind == ControllerKind::kRodTrack;
}

/// The step of the measured wrist that moves the true one by `step`: each axis first crosses its
/// play, but for a tenth of it that is left to the next steps, so that a play overrated does not
/// make the loop swing. A step that is small against the play does not turn the direction around.
Eigen::Vector3d LeadByPlay(const Eigen::Vector3d& step, const ShaftModel& model) {
  constexpr double kSmall = 0.02, kCrossed = 0.9;
  const double play = model.wrist_play_m;
  Eigen::Vector3d lead = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (std::abs(step[i]) <= kSmall * play) continue;
    // True less measured by the play: at its end it is half of it behind.
    const double by_play_m = model.wrist_shift_m[i] - model.wrist_misread_m[i];
    const double offset = by_play_m + std::copysign(0.5 * play, step[i]);
    lead[i] = kCrossed * offset;
  }
  return step + lead;
}

}  // namespace

const char* Name(ControllerKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<ControllerKind> ControllerKindNamed(std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return {};
  return static_cast<ControllerKind>(found - kNames.begin());
}

bool UsesTipMeasurement(ControllerKind kind) {
  return kind == ControllerKind::kStraightTrack || kind == ControllerKind::kFlexTrack ||
         kind == ControllerKind::kRodTrack;
}

const char* Name(ControlStatus status) {
  switch (status) {
    case ControlStatus::kOk:
      return "ok";
    case ControlStatus::kBadInput:
      return "bad_input";
    case ControlStatus::kNoTip:
      return "no_tip";
    case ControlStatus::kNoModel:
      return "no_model";
    case ControlStatus::kStraightInstead:
      return "straight_instead";
    case ControlStatus::kNoGoal:
      return "no_goal";
    case ControlStatus::kNoWrist:
      return "no_wrist";
  }
  return "";
}

double CorrectionPart(const ControllerOptions& options) {
  const double cycles = options.correction_s * options.rate_hz;
  return cycles > 1.0 ? 1.0 / cycles : 1.0;
}

ControlOutput TipController::Step(const ControlInput& input) {
  ControlOutput hold;
  hold.p_RW_command = wrist_.Hold(input.p_RW);
  const bool tracks = UsesTipMeasurement(options_.kind);
  hold.status = ControlStatus::kBadInput;
  if (!IsPlausible(options_) || !IsPlace(input.p_RW) || !IsPlace(input.p_RE_desired)) return hold;
  if (tracks && input.tip_measured && !IsPlace(input.p_RE_measured)) return hold;
  hold.status = ControlStatus::kNoTip;
  if (tracks && !input.tip_measured) return hold;
  hold.status = ControlStatus::kNoModel;
  if (!IsPlausible(input.model)) return hold;

  const Prediction model = Predict(input, options_, rod_);
  if (model.status == ControlStatus::kNoModel) return hold;
  if (!model.p_RE.allFinite() || !model.J_tip_wrist.allFinite()) return hold;
  ControlOutput output = hold;
  output.status = model.status;
  output.J_tip_wrist = model.J_tip_wrist;
  output.p_RE_used = tracks ? input.p_RE_measured : model.p_RE;

  const Eigen::Vector3d dx = options_.gain * (input.p_RE_desired - output.p_RE_used);  // (2.1)
  Eigen::Vector3d step = SolveDamped(dx, options_, output);                            // (5.1)
  if (UsesRod(options_.kind) && input.model.wrist_play_m > 0.0)
    step = LeadByPlay(step, input.model);
  if (!step.allFinite()) return hold;
  const bool goes_on = input.last && CorrectionPart(options_) < 1.0 && IsPlace(input.last->p_RW) &&
                       IsPlace(input.last->p_RE_desired);
  if (goes_on) {
    const Eigen::Vector3d p_whole =
        input.p_RW + BoundStep(step, input.p_RW, input.model, options_.max_step_m).step_m;
    step = GoOn(*input.last, input, options_, p_whole, output) - input.p_RW;
    if (!step.allFinite()) return hold;
  }
  const BoundedStep bounded = BoundStep(step, input.p_RW, input.model, options_.max_step_m);
  output.step_limited = bounded.limited;
  output.p_RW_command += bounded.step_m;
  return output;
}

}  // namespace flextip
