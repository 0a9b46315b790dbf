// Terms as effects like others: a model of the answer's effects and the terms, fitted together.
#pragma once

#include <memory>
#include <vector>

#include "diagnosis/diagnose.h"
#include "diagnosis/discovery/discover.h"
#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

/// The layout holds the catalogue, then the terms, then the nuisances. Not to be moved: replays
/// refer to the layout.
struct TermModel {
  ParameterLayout layout;
  Replay base, extended;
  int first_term = 0;  ///< block of the first term
  std::vector<FoundTerm> found;
  Selection selection;        ///< the problem about the fit
  WeighedHypothesis weighed;  ///< the effects and the terms

  /// The effects' names; {"none"} where there are terms alone.
  Verdict Named() const;
  /// The terms as they are fitted.
  std::vector<FoundTerm> Fitted() const;

  TermModel(const SampleSet& samples, Catalogue catalogue, int terms);
  TermModel(const TermModel&) = delete;
  TermModel& operator=(const TermModel&) = delete;
};

/// Fits `effects` (blocks of `from`'s layout) and `found` from where `from` stands, which may have
/// terms of its own: those of `found` are in their place. `base` stands at the base simulation.
/// Null where the instrument has no equilibrium there.
std::unique_ptr<TermModel> FitTerms(const Replay& base, const Replay& from,
                                    const Selection& selection, const std::vector<int>& effects,
                                    const std::vector<FoundTerm>& found,
                                    const DiagnoseOptions& options);

}  // namespace flextip::diagnosis
