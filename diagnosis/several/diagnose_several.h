// The diagnosis of several recordings of one instrument together: what all have in common, what
// began between two, and each one's own answer in the light of the others.
#pragma once

#include <string>
#include <vector>

#include "core/judgement.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/several/helpers.h"

namespace flextip::diagnosis {

struct NamedRecording {
  std::string name;  ///< in results, and in messages
  Recording recording;
};

/// An effect that is present from one recording on and not in those before it.
struct FoundChange {
  std::string effect;
  std::size_t first_in = 0;  ///< the recording, counted from zero
  double probability = 0.0;
  std::vector<ReportedParameter> parameters;
};

struct SeveralResult {
  /// What is in all recordings. Parameters that are each recording's own are the first one's;
  /// errors and gain are over all.
  DiagnosisResult common;
  std::vector<std::string> names;
  std::vector<DiagnosisResult> own;  ///< of each recording in the light of the others
  std::vector<FoundChange> changes;
};

/// In order of time. `helpers` share the work; the result is the same. A motion that is planned
/// goes on from the last recording, in the light of all. Throws as Diagnose does, and InputError
/// where the recordings are not of one instrument.
SeveralResult DiagnoseSeveral(const std::vector<NamedRecording>& recordings,
                              const DiagnoseOptions& options = {}, const Helpers& helpers = {});

/// Throws InputError where the recordings cannot be stretches of one session (recording/join.h):
/// another instrument, a sensor that says something else of itself, or a wrist that begins
/// elsewhere than it had ended.
void RequireOneSession(const std::vector<NamedRecording>& recordings);

/// As JudgeDiagnosis does, with what began.
Judgement JudgeSeveral(const SeveralResult& several);

}  // namespace flextip::diagnosis
