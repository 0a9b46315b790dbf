// The files of a diagnosis as text: diagnosis.json and residuals.csv (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/diagnose.h"
#include "diagnosis/several/diagnose_several.h"
#include "simulation/closed_loop/gain.h"

namespace flextip {

/// Returns diagnosis.json. `gain`, where there is one, adds `closed_loop_runs`, each controller
/// that ran, and `closed_loop`, the rod controller that sees the tip.
std::string DiagnosisJson(const diagnosis::DiagnosisResult& result,
                          const simulation::ClosedLoopGain* gain = nullptr);

/// Returns diagnosis.json of several recordings: that of what all have in common, with
/// `recordings`, `presence_in` (of each effect by recording) and `changes`.
std::string DiagnosisJson(const diagnosis::SeveralResult& several,
                          const simulation::ClosedLoopGain* gain = nullptr);

/// Returns residuals.csv: the ResidualTable, six digits a number; an absent measurement is empty.
std::string ResidualsCsv(const diagnosis::ResidualTable& residuals);

/// Returns discovered.csv: of each term the variable, what the sensors say of it and what it says,
/// sample by sample, thinned to a thousand; empty without terms.
std::string DiscoveredCsv(const std::vector<diagnosis::Discovered>& terms);

/// Writes into `folder` what a diagnosis has beside its page: `json`, residuals.csv, model.yaml,
/// discovered.csv where there are terms and motion.yaml where one was planned. Throws WorkError.
void WriteDiagnosisFiles(const std::filesystem::path& folder, const std::string& json,
                         const diagnosis::DiagnosisResult& result);

}  // namespace flextip
