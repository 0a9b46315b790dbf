// Pictures of residuals.csv: what they depend on, over time, and how they remember.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/diagnose/result.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {

/// The column a signature's regressor has ("time" is t_s); nullptr where absent.
const std::vector<double>* RegressorColumn(const ResultTable& residuals, const std::string& name);

/// How many components of `channel` ("em0_position_m") the table has for `model` ("base").
std::size_t ComponentCount(const ResultTable& residuals, const std::string& model,
                           const std::string& channel);

/// The channels for which there are residuals of both models, in the order of the file.
std::vector<std::string> ResidualChannels(const ResultTable& residuals);

/// Root mean square of a channel's residuals, all components; nothing where none was measured.
std::optional<double> ResidualRms(const ResultTable& residuals, const std::string& model,
                                  const std::string& channel);

/// The component of the channel whose base residual varies most from bin to bin of the regressor.
std::size_t TellingComponent(const ResultTable& residuals, const DiagnosedSignature& signature);

/// Base and extended residual of that component against the regressor, with the means of 20 bins;
/// nothing where the table has not what the signature names.
std::optional<Figure> SignaturePlot(const ResultTable& residuals,
                                    const DiagnosedSignature& signature);
/// The same component over time.
std::optional<Figure> TimePlot(const ResultTable& residuals, const DiagnosedSignature& signature);

/// Autocorrelation of each channel's residuals with `model`, mean over its components; lags in
/// seconds, with the band that white noise keeps to (95 %).
struct Memory {
  Figure plot = {};
  std::vector<std::string> not_white = {};  ///< channels, as spoken, with the remaining correlation
};
Memory ResidualMemory(const ResultTable& residuals, const std::string& model);

}  // namespace flextip::report
