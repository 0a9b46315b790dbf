// diagnosis.json as the page needs it. What is absent in the file is empty here: a page can be made
// of an older or a shorter answer.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace flextip::report {

/// One named parameter of an effect, in SI; all lists have the size of `value`, or are empty.
struct DiagnosedParameter {
  std::string effect = {}, name = {};
  std::vector<double> value = {}, sd = {};
  std::vector<double> nominal = {};    ///< values of the base simulation
  std::vector<double> tolerance = {};  ///< one standard deviation of values within specification
  bool is_list = false;
  std::vector<bool> joint_turns = {};  ///< of an arm's effect: which joints turn, the others slide

  /// How far component `i` is from nominal, in tolerances; nothing where it has none.
  std::optional<double> TolerancesOff(std::size_t i) const;
};

struct DiagnosedScore {
  std::map<std::string, double> heldout_rms;  ///< by channel, in its unit
  std::optional<double> tip_prediction_rms_m, weighted_rms, chi2_per_dof;
};

struct DiagnosedSignature {
  std::string channel, against;
  double score = 0.0;
};

/// A term without a name, as `discovered` has it.
struct DiagnosedTermName {
  std::string channel, form;
  std::vector<std::string> depends_on;
};
struct DiagnosedTerm {
  DiagnosedTermName name;
  std::string text;
  std::vector<DiagnosedParameter> parameters;
  double false_discovery = 1.0, part_of_samples = 0.0;
  std::optional<double> heldout_error_ratio;
  std::vector<double> depth_m;  ///< where it is large, from and to
  std::vector<DiagnosedTermName> could_be;
};

/// A joint of an arm in closed loop: "q1_rad" or "q3_m".
struct DiagnosedLoopJoint {
  std::string component;
  std::optional<double> rms_before, rms_after, max_before, max_after;
};

/// `closed_loop` of the file: how far one controller strays from its path with either model.
struct DiagnosedLoop {
  std::string controller;
  std::optional<double> max_before_m, max_after_m, rms_before_m, rms_after_m;
  std::vector<DiagnosedLoopJoint> joints;  ///< of an arm
  std::vector<std::string> notes;          ///< what the simulated arm does not have, and why
};

/// Effects as one hypothesis: sorted, with "+" between.
std::string JoinedEffects(std::vector<std::string> effects);

struct DiagnosedResult {
  std::vector<std::string> verdicts;
  std::vector<std::pair<std::string, double>> probabilities;  ///< most likely first
  std::vector<std::pair<std::string, double>> presence;       ///< for each effect, likeliest first
  std::vector<std::string> credible_set;                      ///< names as in probabilities
  std::vector<std::vector<std::string>> indistinguishable;    ///< one group for each verdict
  std::string separating_motion;
  std::optional<double> separating_score;  ///< twice the log odds by that motion
  std::string planned_motion;              ///< a sentence; empty: none was asked for
  std::vector<DiagnosedParameter> parameters, within_tolerance;
  std::vector<DiagnosedTerm> discovered;
  DiagnosedScore base, extended;
  std::optional<double> heldout_error_ratio, tip_error_ratio;
  std::optional<std::pair<double, double>> heldout_error_interval;
  bool adequate = true;  ///< else probabilities hold among the known causes alone
  std::vector<DiagnosedSignature> signatures;  ///< strongest first
  std::map<std::string, double> noise_scale;   ///< measured over data sheet's, by channel
  std::map<std::string, double> noise_sd;      ///< in the channel's unit, by channel
  std::map<std::string, std::string> summaries;
  std::optional<DiagnosedLoop> closed_loop;
  std::vector<std::string> catalogue, warnings;
  std::vector<std::pair<std::string, double>> counts;  ///< samples, failed_samples, fits

  bool Is(const std::string& answer) const;  ///< the verdict is this alone
  /// Of the hypothesis of these effects together, in whatever order; zero where not listed.
  double Probability(const std::vector<std::string>& effects) const;
  /// Of the verdict, together with all that the recording cannot tell apart from it.
  double VerdictProbability() const;
  /// Every combination of one effect from each group, the verdict among them.
  std::vector<std::vector<std::string>> Equivalents() const;
};

/// Throws InputError where the file cannot be read, is no JSON, or holds something else than
/// docs/formats.md says.
DiagnosedResult ReadDiagnosedResult(const std::filesystem::path& path);

/// What summary.json says of the run: names and values as shown, and the warnings.
struct RunSummary {
  std::string command = {}, version = {};
  std::vector<std::pair<std::string, std::string>> figures = {};
  std::vector<std::string> warnings = {};
};
RunSummary ReadRunSummary(const std::filesystem::path& path);

}  // namespace flextip::report
