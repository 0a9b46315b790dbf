#include "bench/matrix_form.h"

#include "diagnosis/catalogue.h"
#include "diagnosis/replay.h"
#include "diagnosis/sample_set.h"

namespace flextip {

Separation MeasureForm(const Recording& with, int attempt, HiddenOptions options,
                       std::uint64_t seed) {
  const Separation none{0.0, ""};
  options.effects.clear();
  const HiddenRecording without = MakeHidden(options, seed);
  if (without.attempt != attempt) return none;
  const SampleSet samples = MakeSampleSet(without.recording, "without");
  const SampleSet changed = MakeSampleSet(with, "with");
  if (samples.samples.size() != changed.samples.size()) return none;
  ParameterLayout layout(samples, MakeCatalogue(samples));
  ParameterLayout changed_layout(changed, MakeCatalogue(changed));
  Replay replay(samples, layout), changed_replay(changed, changed_layout);
  const Eigen::VectorXd base = Eigen::VectorXd::Zero(layout.Size());
  if (!replay.Evaluate(base) || !changed_replay.Evaluate(base)) return none;
  replay.FixNoiseModel();
  changed_replay.TakeSettings(replay);
  const WhitenedRows rows = replay.Whiten(), changed_rows = changed_replay.Whiten();
  if (rows.first_row != changed_rows.first_row) return none;
  const Eigen::VectorXd z = changed_rows.e - rows.e;
  return NearestKnown(rows.X.transpose() * rows.X, rows.X.transpose() * z, z.squaredNorm(), layout);
}

}  // namespace flextip
