// The parts of the diagnosis page: bars and the shaded table of signatures.
#pragma once

#include <string>
#include <vector>

#include "report/diagnose/result.h"
#include "report/diagnose/words.h"
#include "report/figure.h"

namespace flextip::report {

/// The likeliest hypotheses, a bar each; none and unknown always. The verdict is darker.
Figure ProbabilityBars(const DiagnosedResult& result);
/// Effects in whatever company; no traces where there are none.
Figure PresenceBars(const DiagnosedResult& result);

/// Signature scores below are what chance gives.
inline constexpr double kChanceScore = 3.0;
/// Channel by regressor, each cell a score; the stronger the darker. Nothing where there are none.
std::string HeatMapHtml(const std::vector<DiagnosedSignature>& signatures);

/// A channel's error with both models, in standard deviations of its noise.
struct ErrorPair {
  std::string label;
  double base = 0.0, extended = 0.0;
};
/// Two bars a channel on one scale, worst first, with a mark at one: the noise.
Figure ErrorBars(const std::string& title, std::vector<ErrorPair> errors,
                 const std::string& caption);

/// A table that is folded until it is clicked.
std::string FoldedTableHtml(const std::string& title, const std::vector<std::string>& header,
                            const std::vector<std::vector<std::string>>& rows);

}  // namespace flextip::report
