#include "bench/diagnosis_matrix/true_model.h"

#include <algorithm>
#include <array>

namespace flextip::bench {

TrueModel::TrueModel(const Recording& recording, const hidden::HiddenRecording& hidden)
    : samples(diagnosis::MakeSampleSet(recording, "recording")),
      layout(samples, diagnosis::MakeCatalogue(samples)),
      parameters(TrueTheta(hidden, layout)),
      replay(samples, layout) {
  for (const std::string& name : hidden.label.present) {
    const int block = layout.Find(name);
    if (block < 0)
      not_shown.push_back(name);
    else
      present.push_back(block);
  }
  std::sort(present.begin(), present.end());
}

bool TrueModel::StandAtTruth() {
  std::array<double, diagnosis::kChannelCount> stated;
  stated.fill(1.0);
  replay.SetNoiseScale(stated);
  if (!replay.Evaluate(parameters.theta)) return false;
  replay.FixNoiseModel();
  return true;
}

}  // namespace flextip::bench
