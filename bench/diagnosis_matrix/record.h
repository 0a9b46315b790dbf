// What is kept of one diagnosis beside its label: one line of cases.jsonl.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bench/diagnosis_matrix/case.h"
#include "bench/diagnosis_matrix/rival.h"

namespace flextip::bench {

using EffectNames = std::vector<std::string>;

/// One number of a parameter of an effect that is present and was found.
struct JudgedParameter {
  std::string effect, parameter;
  int entry = 0;
  double truth = 0.0, value = 0.0, sd = 0.0;
  /// On sd (bound.h). 0 where not measured as the verdict was wrong, or where the number
  /// does not change to first order (an axis along itself).
  double bound = 0.0;
};

struct MatrixRecord {
  MatrixCase made;
  std::string key;
  std::string motion, load;  ///< kinds
  int attempt = 0;           ///< draws that had no equilibrium
  EffectNames label;         ///< right answer, sorted: effects, or none, or unknown
  std::string form;          ///< where unknown: which
  /// Of a single effect, a pair or three from their nearest rival (rival.h), of a form
  /// outside the catalogue from all that is in it (form.h), of an effect that was left out
  /// from up to three of the others together.
  double separation = 0.0;
  std::string rival;  ///< empty where that was not measured
  std::string error;  ///< a refusal's message; the members below are empty then

  EffectNames verdict;
  std::vector<std::pair<EffectNames, double>> probabilities;  ///< the eight most likely
  double p_verdict = 0.0, p_truth = 0.0;
  bool truth_in_credible_set = false;
  int credible_set_size = 0;
  std::vector<EffectNames> indistinguishable;  ///< one group for each verdict
  int terms = 0;                               ///< without a name, found in the residuals
  /// Where an effect was left out of the catalogue: what the full one says of the same recording.
  EffectNames full_verdict;
  std::vector<EffectNames> full_indistinguishable;
  std::vector<JudgedParameter> parameters;
  bool gain_measured = false;
  double heldout_error_ratio = 1.0, tip_error_ratio = 1.0;  ///< extended over base
  double extended_weighted_rms = 0.0;                       ///< held out, in noise sd
  double heldout_over_true = 0.0;  ///< the same over that of the true model; 0: not measured
  double base_chi2_per_dof = 0.0, extended_chi2_per_dof = 0.0;
  int fits = 0;
  bool converged = false;
  double seconds = 0.0;  ///< time of Diagnose alone
  EffectNames warnings;

  bool IsRight() const { return verdict == label; }
  /// One effect, two or three that the recording holds enough to tell.
  bool IsSeparable() const { return !rival.empty() && separation >= kSeparable; }
  /// Whether every effect of the label is in the verdict, or in a group declared indistinguishable
  /// from it.
  bool IsRightOrDeclared() const;
};

/// "a+b".
std::string JoinedNames(const EffectNames& names);

std::string JsonLine(const MatrixRecord& record);

/// All records of a file; none where it is missing. A last line that was cut off is left out.
/// Throws InputError for any other line that is none.
std::vector<MatrixRecord> ReadRecords(const std::filesystem::path& file);

}  // namespace flextip::bench
