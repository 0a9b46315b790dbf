#include "apps/diagnose/held.h"

#include "apps/common/input/input_check.h"
#include "apps/diagnose/arm_files.h"
#include "apps/diagnose/result_files.h"
#include "arms/diagnose/model_file.h"
#include "recording/text/text.h"
#include "report/figure.h"

namespace flextip {

diagnosis::EffectMakers ShaftInput::JointEffects() const {
  return held ? held->Effects() : diagnosis::EffectMakers{};
}

ShaftInput ReadShaft(const RecordingInput& input, const plausibility::CommandUse& use, bool quiet,
                     bool needs_joints) {
  ShaftInput shaft{ReadInput(input), nullptr};
  if (arms::HoldsShaft(shaft.read.recording) && (needs_joints || !shaft.read.recording.wrist0)) {
    shaft.held = std::make_shared<arms::HeldShaft>(shaft.read.recording, input.recording.string());
    shaft.read.recording = shaft.held->WithWrist();
    shaft.read.warnings.insert(shaft.read.warnings.end(), shaft.held->Warnings().begin(),
                               shaft.held->Warnings().end());
  }
  shaft.read.findings =
      CheckInput({input.no_check, quiet, input.silent}, use, shaft.read.recording);
  return shaft;
}

diagnosis::DiagnosisResult DiagnoseHeldShaft(const ShaftInput& input, const std::string& name,
                                             const diagnosis::DiagnoseOptions& options,
                                             const std::filesystem::path& folder) {
  const arms::HeldResult result =
      arms::DiagnoseHeld(*input.held, input.read.recording, name, options);
  WriteDiagnosisFiles(folder, HeldDiagnosisJson(result, input.held->Data().arm), result.shaft);
  if (!result.arm) return result.answer;
  WriteTextFile(folder / "arm_model.yaml", arms::ArmModelYaml(result.arm->model));
  report::WriteFigures(folder / "figures.json", ArmFigures(*result.arm));
  return result.answer;
}

}  // namespace flextip
