// The parameters in which the model is far from linear, such as a frequency: found by a scan.
#pragma once

#include <vector>

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Scans the parameters of `blocks` anew, one after the other, and moves each effect to the value
/// whose two shapes, in the effect's inputs, explain most of the residual that the other
/// parameters, of prior deviations `prior_sd`, leave. A value found before stays where the scan
/// confirms it.
void ScanAgain(Replay& replay, ParameterLayout& layout, const std::vector<int>& blocks,
               const Eigen::VectorXd& prior_sd);

/// Returns the centres about which the scanned parameters are fitted, in the layout's order.
std::vector<double> ScanCentres(const ParameterLayout& layout);
void SetScanCentres(ParameterLayout& layout, const std::vector<double>& centres);

}  // namespace flextip::diagnosis
