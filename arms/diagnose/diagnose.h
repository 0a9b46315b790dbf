// The whole diagnosis of an arm: what its recordings hold that the simulation by its file does not,
// joint by joint, and what a model extended by it gains.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "arms/replay/layout.h"
#include "diagnosis/diagnose.h"

namespace flextip::arms {

struct ArmOptions {
  std::vector<std::string> without;  ///< effects left out of the catalogue
};

/// An effect that some recordings have and those before them do not.
struct Change {
  std::string effect;
  int first_in = 0;
  double probability = 0.0;
  std::vector<diagnosis::ReportedParameter> parameters;
};

/// What is left of one component of one sensor, root mean square on stretches not fitted (SI).
struct ComponentScore {
  std::string channel, component;
  int joint = -1;  ///< from 0; -1: of no joint
  double noise = 0.0, memory = 0.0, base = 0.0, extended = 0.0;
};

/// Measured and predicted of one component over time, thinned, for pictures.
struct ComponentCurve {
  std::string channel, component;
  int recording = 0;
  std::vector<double> t_s, input, measured, base, extended;
};

/// All parameters as a model keeps them: effects that were found, effects within tolerance and
/// nuisances; the base's nuisances beside them.
struct ArmModel {
  std::vector<diagnosis::EffectFit> effects, within_tolerance, nuisances, base_nuisances;
};

/// The parameters of an effect of the model, as effects of arms take them.
std::vector<ArmParameter> ParametersOf(const diagnosis::EffectFit& fit);

struct RecordingAnswer {
  std::string name;
  diagnosis::DiagnosisResult answer;
};

struct ArmResult {
  diagnosis::DiagnosisResult answer;  ///< of what all recordings have in common
  std::vector<std::string> recordings;
  std::vector<Change> changes;
  std::vector<std::string> not_told;  ///< numbers that the recordings do not hold, and why
  std::vector<ComponentScore> components;
  std::vector<ComponentCurve> curves;
  std::vector<RecordingAnswer> each;  ///< of several recordings
  /// How likely each effect is in each of several recordings; effects without any chance left out.
  std::map<std::string, std::vector<double>> presence_in;
  ArmModel model;
  std::vector<std::string> joint_types;
  std::vector<Eigen::Vector2d> side_view;   ///< base and joints in a plane (m), for a drawing
  std::vector<std::string> joint_findings;  ///< a joint each: what is wrong with it, in words
};

/// Throws InputError where the recordings are not of one arm, hold nothing beside the joints, and
/// for names in `without` that no effect has.
ArmResult Diagnose(const std::vector<ArmData>& recordings, const ArmOptions& options = {});

}  // namespace flextip::arms
