// The whole diagnosis of an arm with the shaft that it holds: from the joints' commands to the bent
// tip.
#pragma once

#include <optional>
#include <string>

#include "arms/diagnose/diagnose.h"
#include "arms/held_shaft/held_shaft.h"

namespace flextip::arms {

struct HeldResult {
  /// Of both together. Errors and gain are those of the shaft's sensors; parameters that both parts
  /// have are the arm's.
  diagnosis::DiagnosisResult answer;
  diagnosis::DiagnosisResult shaft;  ///< its part: what moves the wrist and bends the shaft
  std::optional<ArmResult> arm;      ///< its part, where joints have sensors beside their encoders
};

/// `recording` is WithWrist() of `held`, maybe checked since. Two parts, whose measurements are
/// apart: the arm's (commands against encoders, efforts, joints and poses seen from outside) and
/// the shaft's, in which the joints move the wrist. Probabilities are multiplied. Throws as
/// diagnosis::Diagnose does, and InputError where a motion is to be planned.
HeldResult DiagnoseHeld(const HeldShaft& held, const Recording& recording, const std::string& name,
                        const diagnosis::DiagnoseOptions& options = {});

/// Returns the answer of both parts together: a hypothesis of each, the product of their
/// probabilities; `unknown` where one of them is.
diagnosis::DiagnosisResult Together(const diagnosis::DiagnosisResult& shaft,
                                    const diagnosis::DiagnosisResult& arm);

}  // namespace flextip::arms
