// The parts of the diagnosis page that are drawn as HTML: bars and the heat map. They are there at
// once, also where no script runs.
#pragma once

#include <string>
#include <vector>

#include "report/diagnose/result.h"
#include "report/diagnose/words.h"

namespace flextip::report {

/// The verdict in large letters, the gain and the advice below.
std::string HeadlineHtml(const Headline& headline);

/// One bar a row.
struct Bar {
  std::string label, value;  ///< as shown
  double share = 0.0;        ///< of the whole width, 0 to 1
  bool strong = false;
};
std::string BarsHtml(const std::string& title, const std::vector<Bar>& bars,
                     const std::string& caption);
/// The likeliest hypotheses; none and unknown always.
std::vector<Bar> ProbabilityBars(const DiagnosedResult& result);
/// Effects in whatever company.
std::vector<Bar> PresenceBars(const DiagnosedResult& result);

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
std::string ErrorBarsHtml(const std::string& title, std::vector<ErrorPair> errors,
                          const std::string& caption);

/// A table that is folded until it is clicked.
std::string FoldedTableHtml(const std::string& title, const std::vector<std::string>& header,
                            const std::vector<std::vector<std::string>>& rows);

}  // namespace flextip::report
