// The files of an arm's diagnosis and prediction as text (docs/formats.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/predict.h"
#include "arms/held_shaft/diagnose_held.h"
#include "report/figure.h"
#include "simulation/closed_loop/joints/joint_gain.h"

namespace flextip {

/// Returns diagnosis.json of all recordings together; `gain`, where there is one, adds
/// `closed_loop`.
std::string ArmDiagnosisJson(const arms::ArmResult& result,
                             const simulation::JointGain* gain = nullptr);
/// Returns diagnosis.json of an arm with the shaft that it holds: its `arm` has what the joints'
/// own sensors say, or the joints' types alone.
std::string HeldDiagnosisJson(const arms::HeldResult& result, const Arm& arm);
/// Returns diagnosis.json of one of several.
std::string ArmRecordingJson(const arms::RecordingAnswer& recording);

/// Returns the summary of a prediction.
nlohmann::json ArmPredictionSummary(const arms::ArmPrediction& prediction);

/// Returns the page's drawings: the arm with its joints coloured, errors by joint, loops of
/// commanded against seen joints, efforts.
std::vector<report::Figure> ArmFigures(const arms::ArmResult& result);
std::vector<report::Figure> CurveFigures(const std::vector<arms::ComponentCurve>& curves);

}  // namespace flextip
