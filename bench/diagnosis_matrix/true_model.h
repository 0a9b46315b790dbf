// The diagnosis's model with the label's parameters, of a recording as read from its folder.
#pragma once

#include <string>
#include <vector>

#include "bench/diagnosis_matrix/truth.h"
#include "diagnosis/replay/replay.h"

namespace flextip::bench {

/// Its form is the diagnosis's own, not the plant's: the plant's friction is a contact, its EM
/// field has a rest of higher order, its breath further overtones. What that leaves is not noise.
class TrueModel {
 public:
  /// `hidden` has effects of the catalogue only. Throws InputError where nothing can be judged
  /// (sample_set.h).
  TrueModel(const Recording& recording, const hidden::HiddenRecording& hidden);
  TrueModel(const TrueModel&) = delete;
  TrueModel& operator=(const TrueModel&) = delete;

  /// Has the replay stand at the label's parameters, with the stated noise and with what else a
  /// replay sets from where it stands (Replay::FixNoiseModel). False where the model has no
  /// equilibrium there.
  bool StandAtTruth();

  const diagnosis::SampleSet samples;
  diagnosis::ParameterLayout layout;
  const TrueParameters parameters;
  /// Blocks of the present effects in order, and names of those that no sensor or motion shows.
  std::vector<int> present;
  std::vector<std::string> not_shown;
  diagnosis::Replay replay;
};

}  // namespace flextip::bench
