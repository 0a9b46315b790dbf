#include "bench/diagnosis_matrix/run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>

#include "bench/diagnosis_matrix/bound.h"
#include "bench/diagnosis_matrix/form.h"
#include "bench/diagnosis_matrix/heldout.h"
#include "bench/diagnosis_matrix/parameters.h"
#include "bench/diagnosis_matrix/separable.h"
#include "core/error.h"
#include "diagnosis/diagnose.h"
#include "recording/recording_reader.h"

namespace flextip::bench {
namespace {

/// A folder that is gone when this is.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> count{0};
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("flextip_matrix_{}_{}", ::getpid(), count++);
    std::filesystem::remove_all(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

EffectNames Sorted(EffectNames names) {
  std::sort(names.begin(), names.end());
  return names;
}

void SetLabel(const hidden::HiddenRecording& hidden, MatrixRecord& record) {
  record.motion = Name(hidden.scene.motion_setup.kind);
  record.load = Name(hidden.scene.load.kind);
  record.attempt = hidden.attempt;
  record.label = Sorted(hidden.label.present);
  if (record.label.empty()) record.label = {"none"};
  for (const std::string& form : hidden::OtherForms()) {
    if (record.label == EffectNames{form}) {
      record.form = form;
      record.label = {"unknown"};
    }
  }
}

bool IsFinite(const MatrixRecord& r) {
  double sum = r.separation + r.p_verdict + r.p_truth + r.heldout_error_ratio + r.tip_error_ratio +
               r.extended_weighted_rms + r.heldout_over_true + r.base_chi2_per_dof +
               r.extended_chi2_per_dof;
  for (const auto& [names, probability] : r.probabilities) sum += probability;
  for (const JudgedParameter& p : r.parameters) sum += p.truth + p.value + p.sd + p.bound;
  return std::isfinite(sum);
}

void SetProbabilities(const diagnosis::DiagnosisResult& result, MatrixRecord& record) {
  for (const diagnosis::HypothesisProbability& h : result.probabilities) {
    const EffectNames names = Sorted(h.verdict);
    if (record.probabilities.size() < 8) record.probabilities.emplace_back(names, h.probability);
    if (names == record.verdict) record.p_verdict = h.probability;
    if (names == record.label) record.p_truth = h.probability;
  }
  for (const diagnosis::Verdict& verdict : result.credible_set) {
    record.truth_in_credible_set |= Sorted(verdict) == record.label;
  }
  record.credible_set_size = static_cast<int>(result.credible_set.size());
}

void SetResult(const diagnosis::DiagnosisResult& result, MatrixRecord& record) {
  record.verdict = Sorted(result.verdict);
  SetProbabilities(result, record);
  record.indistinguishable = result.indistinguishable;
  record.terms = int(result.discovered.size());
  record.gain_measured = result.gain.measured;
  record.heldout_error_ratio = result.gain.heldout_error_ratio;
  record.tip_error_ratio = result.gain.tip_error_ratio;
  record.extended_weighted_rms = result.extended.weighted_rms;
  record.base_chi2_per_dof = result.base.chi2_per_dof;
  record.extended_chi2_per_dof = result.extended.chi2_per_dof;
  record.fits = result.fits;
  record.converged = result.converged;
  record.warnings = result.warnings;
}

void SetSeparation(const Separation& separation, MatrixRecord& record) {
  record.separation = separation.value;
  record.rival = separation.rival;
}

/// How near the right answer comes to what anyone could say of the recording.
void SetAgainstTruth(TrueModel& truth, const diagnosis::DiagnosisResult& result,
                     MatrixRecord& record) {
  SetBounds(CramerRaoBounds(truth), record.parameters);
  if (!result.gain.measured) return;
  const double error = TrueHeldOutError(truth, result.noise_scale);
  if (error > 0.0) record.heldout_over_true = result.extended.weighted_rms / error;
}

MatrixRecord Judge(const Recording& recording, const hidden::HiddenRecording& hidden,
                   std::optional<TrueModel>& truth, MatrixRecord record) {
  const std::string name = "recording";
  diagnosis::DiagnoseOptions options;
  if (!record.made.without.empty()) {
    options.measure_gain = false;
    const diagnosis::DiagnosisResult full = diagnosis::Diagnose(recording, name, options);
    record.full_verdict = Sorted(full.verdict);
    record.full_indistinguishable = full.indistinguishable;
    options.without = {record.made.without};
  }
  const auto start = std::chrono::steady_clock::now();
  const diagnosis::DiagnosisResult result = diagnosis::Diagnose(recording, name, options);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  record.seconds = seconds.count();
  if (!record.made.without.empty()) record.label = {"unknown"};
  SetResult(result, record);
  record.parameters = JudgeParameters(hidden, result);
  if (truth && record.IsRight()) SetAgainstTruth(*truth, result, record);
  if (!IsFinite(record)) throw WorkError("the result holds a number that is not finite");
  return record;
}

}  // namespace

MatrixRecord RunMatrixCase(const MatrixCase& one) {
  MatrixRecord record;
  record.made = one;
  record.key = one.Key();
  try {
    const hidden::HiddenRecording hidden = hidden::MakeHidden(HiddenOptionsOf(one), one.seed);
    SetLabel(hidden, record);
    const TemporaryFolder folder;
    hidden::WriteHidden(folder.Path(), hidden);
    const Recording recording = ReadRecording(folder.Path()).recording;
    std::optional<TrueModel> truth;
    if (one.part == "singles" || one.part == "pairs" || one.part == "triples") {
      truth.emplace(recording, hidden);
      SetSeparation(MeasureSeparation(*truth), record);
    } else if (one.part == "leave_effect") {
      TrueModel whole(recording, hidden);
      SetSeparation(MeasureDeleted(whole), record);
    } else if (one.part == "unknown") {
      SetSeparation(MeasureForm(recording, hidden.attempt, HiddenOptionsOf(one), one.seed), record);
    }
    record = Judge(recording, hidden, truth, record);
  } catch (const InputError& error) {
    record.error = error.what();
  } catch (const WorkError& error) {
    record.error = error.what();
  }
  return record;
}

}  // namespace flextip::bench
