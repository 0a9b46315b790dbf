// A discovered term as an effect like others: fitted jointly with the named ones, undone in
// estimation and control.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "diagnosis/effects/discovered/term.h"
#include "diagnosis/effects/discovered/term_columns.h"
#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// What the term's amplitudes, offsets and, of shapes without memory, parameters are fitted about.
/// Fitted are amplitude (column by column), offset, and corrections of RefinedAt's parameters.
class DiscoveredTerm : public Effect {
 public:
  /// `at_sd`: prior deviations of the corrections, as many as RefinedAt gives; empty: held.
  DiscoveredTerm(Term term, std::string name, std::vector<double> at_sd = {});

  std::string Name() const override { return name_; }
  std::string Summary() const override { return "found in the residuals"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override;
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override;
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override;
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override;
  bool NeedsPortPlace() const override;

  const Term& Found() const { return term_; }
  /// The fitted values of the term as it was found.
  Eigen::VectorXd Theta() const;
  /// The term with the values of `theta`.
  Term With(const Eigen::VectorXd& theta) const;

 private:
  Eigen::Index AmplitudeSize() const { return term_.amplitude.size(); }
  void AddShapeDerivatives(const Term& at, const double* theta, const TermState& state,
                           InputChange& change) const;

  Term term_;
  std::string name_;
  std::vector<int> refined_;
  std::vector<double> at_sd_;
};

/// Returns which of the shape's parameters a fit may correct.
std::vector<int> RefinedAt(const Term& term);

}  // namespace flextip::diagnosis
