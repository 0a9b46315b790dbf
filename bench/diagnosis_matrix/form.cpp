#include "bench/diagnosis_matrix/form.h"

#include "diagnosis/model/catalogue.h"
#include "diagnosis/replay/replay.h"
#include "diagnosis/samples/sample_set.h"

namespace flextip::bench {

Separation MeasureForm(const Recording& with, int attempt, hidden::HiddenOptions options,
                       std::uint64_t seed) {
  const Separation none{0.0, ""};
  options.effects.clear();
  const hidden::HiddenRecording without = hidden::MakeHidden(options, seed);
  if (without.attempt != attempt) return none;
  const diagnosis::SampleSet samples = diagnosis::MakeSampleSet(without.recording, "without");
  const diagnosis::SampleSet changed = diagnosis::MakeSampleSet(with, "with");
  if (samples.samples.size() != changed.samples.size()) return none;
  diagnosis::ParameterLayout layout(samples, diagnosis::MakeCatalogue(samples));
  diagnosis::ParameterLayout changed_layout(changed, diagnosis::MakeCatalogue(changed));
  diagnosis::Replay replay(samples, layout), changed_replay(changed, changed_layout);
  const Eigen::VectorXd base = Eigen::VectorXd::Zero(layout.Size());
  if (!replay.Evaluate(base) || !changed_replay.Evaluate(base)) return none;
  replay.FixNoiseModel();
  changed_replay.TakeSettings(replay);
  const diagnosis::WhitenedRows rows = replay.Whiten(), changed_rows = changed_replay.Whiten();
  if (rows.first_row != changed_rows.first_row) return none;
  const Eigen::VectorXd z = changed_rows.e - rows.e;
  return NearestKnown(rows.X.transpose() * rows.X, rows.X.transpose() * z, z.squaredNorm(), layout);
}

}  // namespace flextip::bench
