#include "diagnosis/effects/discovered/term.h"

#include "diagnosis/replay/sample_input.h"

namespace flextip::diagnosis {
namespace {

using namespace sample_input;

constexpr TermTargetInfo kTargets[kTermTargets] = {
    {"em0_position_m", "the EM position", kEmOffset, 3, 1.0, 1e-4, "m", "R"},
    {"em0_orientation_rad", "the EM orientation", kEmReadTurn, 3, 1.0, 1e-3, "rad", "R"},
    {"strain0_moment_Nm", "the strain reading", kStrainOffset, 4, 1.0, 1e-3, "Nm", "gages"},
    {"vision0_position_m", "the seen tip position", kVisionShift, 3, 1.0, 2e-4, "m", "R"},
    {"vision0_direction_rad", "the seen direction", kTipReadTurn, 3, 1.0, 1e-3, "rad", "R"},
    {"wrist0_orientation_rad", "the wrist's orientation", kWristReadTurn, 3, 1.0, 1e-3, "rad", "R"},
    {"wrist0_position_m", "the wrist's position", kWrist, 3, -1.0, 1e-4, "m", "R"},
    {"load0_force_N", "the load cell", kForce, 3, -1.0, 5e-3, "N", "R"},
    {"port_position_m", "the port", kPort, 3, 1.0, 1e-4, "m", "R"},
    {"stiffness", "the stiffness (its logarithm)", kStiffness, 1, 1.0, 0.02, "", "shaft"},
    {"port_friction", "the friction of the port", kPortFriction, 1, 1.0, 0.06, "", "shaft"},
    {"shaft_load_N_m", "a load along the shaft beyond the port", kInside, 3, 1.0, 0.02, "N_m", "R"},
    {"curvature_1_m", "the shaft's own curvature", kCurvature, 2, 1.0, 0.003, "1_m", "instrument"},
    {"em0_time_s", "the stamp of the EM readings", kEmDelay, 1, 1.0, 5e-4, "s", "stamps"},
    {"vision0_time_s", "the stamp of the frames", kCameraDelay, 1, 1.0, 5e-4, "s", "stamps"},
};

constexpr const char* kVariableNames[kTermVariables] = {
    "time",      "insertion_depth",    "sliding_velocity", "wrist_speed", "port_force",
    "load",      "distance_to_camera", "position",         "orientation", "image_position",
    "own_value", "previous_samples"};

constexpr const char* kVariableUnits[kTermVariables] = {"s", "m", "m_s", "m_s", "N", "N",
                                                        "m", "m", "",    "",    "",  ""};

constexpr const char* kFormNames[kTermForms] = {"constant",   "linear",   "quadratic",
                                                "periodic",   "step",     "saturating",
                                                "hysteresis", "decaying", "other"};

constexpr const char* kShapeNames[kTermShapes] = {
    "constant", "linear",      "quadratic",     "periodic",    "step",   "beyond",
    "below",    "band",        "tanh",          "exponential", "after",  "relaxing",
    "play",     "smooth_play", "inverse_power", "past_plane",  "smooth", "radial"};

template <class Enum, class NameOf>
std::optional<Enum> Named(std::string_view name, int count, NameOf name_of) {
  for (int i = 0; i < count; ++i)
    if (name == name_of(static_cast<Enum>(i))) return static_cast<Enum>(i);
  return {};
}

}  // namespace

const TermTargetInfo& InfoOf(TermTarget target) { return kTargets[static_cast<int>(target)]; }
bool IsStamp(TermTarget target) {
  return target == TermTarget::kEmTime || target == TermTarget::kVisionTime;
}
const char* Name(TermVariable variable) { return kVariableNames[static_cast<int>(variable)]; }
const char* Name(TermForm form) { return kFormNames[static_cast<int>(form)]; }
const char* Name(TermShape shape) { return kShapeNames[static_cast<int>(shape)]; }

const char* UnitOf(TermVariable variable, TermTarget target) {
  if (variable == TermVariable::kOwnValue) return InfoOf(target).unit;
  return kVariableUnits[static_cast<int>(variable)];
}

int Dimension(TermVariable variable) {
  if (variable == TermVariable::kPosition || variable == TermVariable::kOrientation) return 3;
  return variable == TermVariable::kImagePosition ? 2 : 1;
}

bool HasMemory(TermShape shape) {
  return shape == TermShape::kRelaxing || shape == TermShape::kPlay ||
         shape == TermShape::kSmoothPlay;
}

int ShapeParameters(TermShape shape, TermVariable variable) {
  switch (shape) {
    case TermShape::kConstant:
      return 0;
    case TermShape::kLinear:
    case TermShape::kQuadratic:
      return Dimension(variable) == 1 ? 1 : 0;
    case TermShape::kRadial:
      return 0;
    case TermShape::kStep:
    case TermShape::kExponential:
    case TermShape::kAfter:
    case TermShape::kSmooth:
      return 2;
    case TermShape::kInversePower:
    case TermShape::kPastPlane:
      return 4;
    default:
      return 1;
  }
}

int ShapeColumns(TermShape shape, TermVariable variable) {
  switch (shape) {
    case TermShape::kConstant:
      return 0;
    case TermShape::kLinear:
    case TermShape::kRadial:
      return Dimension(variable);
    case TermShape::kQuadratic: {
      const int n = Dimension(variable);
      return n + n * (n + 1) / 2;
    }
    case TermShape::kPeriodic:
      return 2;
    case TermShape::kSmooth:
      return kSplines;
    default:
      return 1;
  }
}

int Term::Columns() const { return ShapeColumns(shape, variable); }

bool Term::IsByInput() const {
  return variable == TermVariable::kOwnValue ||
         (variable == TermVariable::kPosition && HasMemory(shape));
}

TermForm FormOf(const Term& term) {
  switch (term.shape) {
    case TermShape::kConstant:
      return TermForm::kConstant;
    case TermShape::kLinear:
      return TermForm::kLinear;
    case TermShape::kQuadratic:
      return TermForm::kQuadratic;
    case TermShape::kPeriodic:
      return TermForm::kPeriodic;
    case TermShape::kStep:
      return TermForm::kStep;
    case TermShape::kBeyond:
    case TermShape::kBelow:
    case TermShape::kBand:
    case TermShape::kTanh:
    case TermShape::kPastPlane:
      return TermForm::kSaturating;
    case TermShape::kExponential: {
      // Nearer to nothing where the exponential is one, it goes the way to saturation.
      if (term.offset.size() == 0 || term.amplitude.size() == 0) return TermForm::kDecaying;
      const double at_begin = (term.offset + term.amplitude.col(0)).norm();
      return at_begin < term.offset.norm() ? TermForm::kSaturating : TermForm::kDecaying;
    }
    case TermShape::kPlay:
    case TermShape::kSmoothPlay:
      return TermForm::kHysteresis;
    case TermShape::kAfter:
    case TermShape::kRelaxing:
    case TermShape::kInversePower:
      return TermForm::kDecaying;
    case TermShape::kSmooth:
    case TermShape::kRadial:
      return TermForm::kOther;
  }
  return TermForm::kOther;
}

std::vector<TermVariable> DependsOn(const Term& term) {
  if (term.shape == TermShape::kConstant) return {};
  if (HasMemory(term.shape)) return {term.variable, TermVariable::kPreviousSamples};
  return {term.variable};
}

std::optional<TermTarget> TargetNamed(std::string_view channel) {
  return Named<TermTarget>(channel, kTermTargets, [](auto t) { return InfoOf(t).channel; });
}
std::optional<TermShape> ShapeNamed(std::string_view name) {
  return Named<TermShape>(name, kTermShapes, [](auto s) { return Name(s); });
}
std::optional<TermVariable> VariableNamed(std::string_view name) {
  return Named<TermVariable>(name, kTermVariables, [](auto v) { return Name(v); });
}

}  // namespace flextip::diagnosis
