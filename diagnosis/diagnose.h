// The whole diagnosis of a recording: the simulation's errors, their causes, the gain of an
// extended model. The main flow is Diagnose() in diagnose.cpp, one stage a line.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/effects/discovered/term.h"
#include "diagnosis/evidence/residual_memory.h"
#include "diagnosis/model/effect.h"
#include "diagnosis/planning/plan.h"
#include "recording/recording.h"

namespace flextip::diagnosis {

struct DiagnoseOptions {
  std::vector<std::string> without;       ///< effects left out of the catalogue
  EffectMakers own_effects = {};          ///< of the user's own, judged like those of the catalogue
  bool discover = true;                   ///< looks for terms that the catalogue does not have
  bool suggest_motion = true;             ///< looks for one that tells alike effects apart
  bool measure_gain = true;               ///< fits on parts of the recording, judged on the rest
  std::optional<MotionLimits> plan = {};  ///< the next motion is planned within these
};

/// Effects together, in alphabetical order; {"none"} and {"unknown"} are answers too.
using Verdict = std::vector<std::string>;
/// Returns "a" or "a+b".
std::string Joined(const Verdict& verdict);
/// Returns whether the verdict names effects: it is neither {"none"} nor {"unknown"}.
bool NamesEffects(const Verdict& verdict);

struct HypothesisProbability {
  Verdict verdict;
  double probability = 0.0;
  double log_evidence = 0.0;  ///< against none
};

struct EffectFit {
  std::string effect;
  std::vector<ReportedParameter> parameters;
};

/// How surely effects within tolerance are known that act on sensors alone. Hand-eye and tag
/// offset, say, are known together much better than each is.
struct SensorTolerance {
  std::vector<std::string> effects;
  Eigen::MatrixXd covariance;  ///< of their reported numbers, in the order of `effects`
};

/// Errors on parts of the recording that were not fitted; channels without measurements are left
/// out. Root mean squares in the channel's unit, of a position's or direction's whole vector and of
/// single gages.
struct ModelScore {
  std::map<std::string, double> heldout_rms;
  double tip_prediction_rms_m = 0.0;  ///< of the tip (or EM sensor) from all other sensors
  double weighted_rms = 0.0;          ///< of all channels, in standard deviations
  double chi2_per_dof = 0.0;          ///< of the whole recording
};

struct Gain {
  bool measured = false;
  double heldout_error_ratio = 1.0;  ///< extended over base, weighted RMS
  double tip_error_ratio = 1.0;
  double heldout_error_ratio_low = 1.0, heldout_error_ratio_high = 1.0;  ///< 90 % interval
};

/// The dependence of a channel's base residual on a quantity. The score is in standard deviations
/// of chance.
struct Signature {
  std::string channel, against;
  double score = 0.0;
};

/// What a term is called: where it acts, what on, and how. No variable: a constant.
struct TermName {
  std::string channel;
  std::vector<std::string> depends_on;
  std::string form;
};
TermName NameOf(const Term& term);

/// Where a term is at least half as large as its largest.
struct TermRegion {
  double largest = 0.0, part = 0.0;  ///< in the channel's unit; part of the samples
  double depth_low_m = 0.0, depth_high_m = 0.0;
  Eigen::Vector3d p_RE_low = Eigen::Vector3d::Zero(), p_RE_high = Eigen::Vector3d::Zero();
};

/// A term drawn along its direction against its variable, sample by sample: what it says, and what
/// the sensors say of it with all else as fitted.
struct TermPicture {
  std::vector<double> variable, term, measured;
};

/// A term that the residuals hold and that no effect of the catalogue explains.
struct Discovered {
  Term term;
  TermName name;
  std::string frame;                          ///< of `direction`: "R", or whose numbers they are
  Eigen::VectorXd direction;                  ///< unit
  std::vector<ReportedParameter> parameters;  ///< in physical units
  std::string text;                           ///< a sentence
  double false_discovery =
      1.0;                 ///< the probability that chance would hold as well on unseen blocks
  double stability = 0.0;  ///< part of resamplings in which the channel stays the same
  std::vector<TermName> could_be;  ///< what the recording cannot tell from it
  TermRegion region;
  TermPicture picture;
  Gain gain;  ///< over the same model without the term
};

/// For pictures: residuals of every sample in standard deviations of each channel's noise (less the
/// part that the tip's force explains), with the base simulation and the extended model.
struct ResidualTable {
  std::vector<std::string> columns;  ///< names: t_s, regressors, base.CHANNEL.i, extended.CHANNEL.i
  std::vector<std::vector<double>> rows;  ///< NaN-free; absent measurements are empty cells:
  std::vector<std::vector<bool>> present;
};

struct DiagnosisResult {
  Verdict verdict{"none"};
  std::vector<HypothesisProbability> probabilities;         ///< most likely first, sum one
  std::map<std::string, double> presence;                   ///< of each effect in whatever company
  std::vector<Verdict> credible_set;                        ///< hypotheses that hold 90 %
  std::vector<std::vector<std::string>> indistinguishable;  ///< one group for each verdict
  std::string separating_motion;  ///< the motion that would tell a group apart; empty: none needed
  double separating_motion_score = 0.0;
  std::optional<NextMotion> plan;           ///< where one was asked for
  std::vector<EffectFit> parameters;        ///< of the verdict's effects
  std::vector<EffectFit> within_tolerance;  ///< of all others, as far as the data moved them
  std::vector<Discovered> discovered;       ///< beside the verdict's effects, or with none of them
  Eigen::MatrixXd covariance;  ///< of the verdict's parameters as listed, all numbers in order
  SensorTolerance sensor_tolerance;                    ///< of `within_tolerance`
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< in R, which EM gradients are about
  TimeNs start_ns = 0;                                 ///< when t = 0, for phases and drifts
  ModelScore base, extended;
  Gain gain;
  ResidualMemory memory;  ///< of what the answer leaves; probabilities and deviations count it
  std::vector<Signature> signatures;  ///< of the base residual, strongest first
  ResidualTable residuals;
  std::array<double, 7> noise_scale{};  ///< measured noise over the data sheet's, by channel
  std::array<double, 7> noise_sd{};     ///< as taken, of one component, by channel
  std::vector<EffectFit> nominal;       ///< of every effect: the base's values, sd the tolerances
  int samples = 0, failed_samples = 0, fits = 0;
  bool converged = false, has_load = false;
  std::vector<std::string> catalogue;            ///< effects that this recording could show
  std::map<std::string, std::string> summaries;  ///< of each of them, a line
  std::vector<std::string> warnings;

  /// Whether the answer's model leaves no more than noise. Else something nobody listed is in the
  /// data too, and probabilities hold among the known causes alone.
  bool IsAdequate() const;
};

/// Throws InputError where nothing can be judged (sample_set.h), for names in `without` that no
/// effect has and for limits of a plan that leave no motion; `name` is the recording's in messages.
DiagnosisResult Diagnose(const Recording& recording, const std::string& name,
                         const DiagnoseOptions& options = {});

}  // namespace flextip::diagnosis
