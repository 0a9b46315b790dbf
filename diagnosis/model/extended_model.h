// The result of a diagnosis as a model to keep in a file and use: model.yaml (docs/formats.md).
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "diagnosis/diagnose.h"

namespace flextip::diagnosis {

/// The base simulation with these effects. In R and SI units, parameters as in docs/effects.md.
struct ExtendedModel {
  std::vector<EffectFit> effects;           ///< beyond tolerance: the verdict's
  std::vector<EffectFit> within_tolerance;  ///< of the others, as far as the data moved them
  std::vector<Term> discovered;             ///< without a name, see discovery
  Eigen::MatrixXd covariance;               ///< of the numbers of `effects` in order; may be empty
  SensorTolerance sensor_tolerance;         ///< of `within_tolerance`; may be empty
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< which EM gradients are about
  TimeNs start_ns = 0;                                 ///< t = 0 of phases and drifts

  /// Returns the fit of an effect beyond or within tolerance; null where the model does not have
  /// the effect.
  const EffectFit* Find(const std::string& effect) const;
};

/// Returns the model that a diagnosis found.
ExtendedModel FromResult(const DiagnosisResult& result);

/// Returns the text of model.yaml.
std::string ModelYaml(const ExtendedModel& model);
/// Throws WorkError where the file cannot be written.
void WriteModel(const std::filesystem::path& file, const ExtendedModel& model);

/// Reads model.yaml with effects of the catalogue and of `own`, in alphabetical order. Throws
/// InputError with file and line for keys, effects or parameters that are unknown or missing, a
/// wrong count, and values that have no meaning (a negative friction, a stiffness of zero).
ExtendedModel ReadModel(const std::filesystem::path& file, const EffectMakers& own = {});

/// Returns the names of the covariance's rows: "port_offset.offset_m[0]" and so on.
std::vector<std::string> NumberNames(const std::vector<EffectFit>& effects);

}  // namespace flextip::diagnosis
