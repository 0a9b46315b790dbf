// A recording of a shaft, which an arm may hold: how `diagnose`, `predict` and `estimate` read it.
#pragma once

#include <memory>

#include "apps/common/input/recording_input.h"
#include "arms/held_shaft/diagnose_held.h"

namespace flextip {

struct ShaftInput {
  InputRead read;                         ///< with wrist0, by the arm's joints where it had none
  std::shared_ptr<arms::HeldShaft> held;  ///< null: no arm holds it

  /// The effects of the arm's joints; none without an arm.
  diagnosis::EffectMakers JointEffects() const;
};

/// As ReadInput does. The check is of the recording with its wrist. With `needs_joints` off, an arm
/// is looked at only where wrist0 is absent.
ShaftInput ReadShaft(const RecordingInput& input, const plausibility::CommandUse& use, bool quiet,
                     bool needs_joints = true);

/// Diagnoses a shaft that an arm holds and writes the files of both parts into `folder`:
/// diagnosis.json, model.yaml of what moves the wrist and bends the shaft, and where joints have
/// sensors beside their encoders arm_model.yaml and figures.json.
diagnosis::DiagnosisResult DiagnoseHeldShaft(const ShaftInput& input, const std::string& name,
                                             const diagnosis::DiagnoseOptions& options,
                                             const std::filesystem::path& folder);

}  // namespace flextip
