// A term of a model that was found in the residuals of a diagnosis and has no name: an input of the
// samples moves by amplitudes times a shape of one variable.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flextip::diagnosis {

/// What a term moves: what a sensor reads, an input, or a parameter that may vary.
enum class TermTarget : std::uint8_t {
  kEmPosition,
  kEmOrientation,
  kStrain,
  kVisionPosition,
  kVisionDirection,
  kWristOrientation,
  kWristPosition,
  kLoad,
  kPort,
  kStiffness,
  kFriction,
  kShaftLoad,
  kCurvature,
  kEmTime,
  kVisionTime,
};
inline constexpr int kTermTargets = 15;

struct TermTargetInfo {
  const char* channel;  ///< name in results
  const char* spoken;   ///< "EM position"
  int first_input;      ///< of sample_input
  int inputs;           ///< 1 to 4
  double sign;          ///< -1 where the input is the truth less the reading
  double tolerance;     ///< what is no matter, in the target's unit
  const char* unit;     ///< suffix of a parameter's name, "m"; empty: none
  const char* frame;    ///< "R", or whose numbers these are
};
const TermTargetInfo& InfoOf(TermTarget target);
/// Returns whether the target is when a sensor says that it read: of time alone.
bool IsStamp(TermTarget target);

enum class TermVariable : std::uint8_t {
  kTime,
  kInsertionDepth,
  kSlidingVelocity,
  kWristSpeed,
  kPortForce,
  kLoad,
  kDistanceToCamera,
  kPosition,
  kOrientation,
  kImagePosition,
  kOwnValue,
  kPreviousSamples,
};
inline constexpr int kTermVariables = 12;
const char* Name(TermVariable variable);
/// The suffix of a parameter's name that has the variable's unit; empty: none.
const char* UnitOf(TermVariable variable, TermTarget target);

enum class TermForm : std::uint8_t {
  kConstant,
  kLinear,
  kQuadratic,
  kPeriodic,
  kStep,
  kSaturating,
  kHysteresis,
  kDecaying,
  kOther,
};
inline constexpr int kTermForms = 9;
const char* Name(TermForm form);

/// A function of the variable v with parameters `at`; a column is multiplied by an amplitude of its
/// own for each input. Where the variable has a component for each input, each input has its own.
enum class TermShape : std::uint8_t {
  kConstant,      ///< no column: the offset alone
  kLinear,        ///< v - at[0]; of a vector a column each component, without at
  kQuadratic,     ///< v - at[0], and its square; of a vector its components and their products
  kPeriodic,      ///< sine and cosine of 2 pi at[0] v
  kStep,          ///< 0 to 1 at at[0], within about at[1]
  kBeyond,        ///< v - at[0] where that is positive
  kBelow,         ///< at[0] - v where that is positive
  kBand,          ///< what of v is beyond -at[0] to at[0]
  kTanh,          ///< tanh(v / at[0])
  kExponential,   ///< exp(-(v - at[1]) / at[0])
  kAfter,         ///< exp(-(v - at[1]) / at[0]) from at[1] on, zero before
  kRelaxing,      ///< of v's past what has not relaxed with time constant at[0]
  kPlay,          ///< where v stands in a play of half width at[0]
  kSmoothPlay,    ///< the same, reached exponentially with the path (Dahl's friction)
  kInversePower,  ///< distance from the place at[0..2] (over 0.1 m) to the power -at[3]
  kPastPlane,     ///< how far the place is beyond the plane of normal at[0..2] at at[3]
  kSmooth,        ///< cubic B-splines between at[0] and at[1], fading to zero outside
  kRadial,        ///< of a vector: each component times the square of its length
};
inline constexpr int kTermShapes = 18;
const char* Name(TermShape shape);

inline constexpr int kMostTermInputs = 4, kMostTermColumns = 9;
inline constexpr int kSplines = 7;  ///< of a smooth term

struct Term {
  TermTarget target = TermTarget::kEmPosition;
  TermShape shape = TermShape::kConstant;
  TermVariable variable = TermVariable::kTime;  ///< without meaning for a constant
  std::vector<double> at = {};                  ///< parameters of the shape
  Eigen::MatrixXd amplitude = {};               ///< inputs x columns, in the target's unit
  Eigen::VectorXd offset = {};                  ///< of each input; empty: none

  int Inputs() const { return InfoOf(target).inputs; }
  int Columns() const;
  /// Returns whether each input has a variable of its own.
  bool IsByInput() const;
};

/// Returns how many parameters `shape` of `variable` has.
int ShapeParameters(TermShape shape, TermVariable variable);
/// Returns how many columns it has.
int ShapeColumns(TermShape shape, TermVariable variable);
/// Returns how many numbers the variable is; of one that has a component an input, 1.
int Dimension(TermVariable variable);
/// Returns whether the shape remembers earlier samples.
bool HasMemory(TermShape shape);

/// How a person would call it: an exponential may be a decay, or the way to saturation.
TermForm FormOf(const Term& term);
std::vector<TermVariable> DependsOn(const Term& term);

std::optional<TermTarget> TargetNamed(std::string_view channel);
std::optional<TermShape> ShapeNamed(std::string_view name);
std::optional<TermVariable> VariableNamed(std::string_view name);

}  // namespace flextip::diagnosis
