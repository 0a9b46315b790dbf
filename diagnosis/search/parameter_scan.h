// The parameters in which the model is far from linear, such as a frequency: found by a scan.
#pragma once

#include <vector>

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Returns the value of the scanned parameter of block `block` whose two shapes, in the effect's
/// inputs, explain most of the residual that the other parameters within their tolerances leave.
double BestScannedValue(const Replay& replay, int block);

/// Scans the parameter of block `block` anew and moves the effect to the value found. A value found
/// before stays where the scan confirms it.
void ScanAgain(Replay& replay, ParameterLayout& layout, int block);

/// Returns the centres about which the scanned parameters are fitted, in the layout's order.
std::vector<double> ScanCentres(const ParameterLayout& layout);
void SetScanCentres(ParameterLayout& layout, const std::vector<double>& centres);

}  // namespace flextip::diagnosis
