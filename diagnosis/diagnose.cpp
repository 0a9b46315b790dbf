#include "diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "diagnosis/discovery/refit.h"
#include "diagnosis/evidence/probabilities.h"
#include "diagnosis/heldout.h"
#include "diagnosis/search/ambiguity.h"
#include "diagnosis/signature.h"

namespace flextip::diagnosis {
namespace {

constexpr double kLongMemory = 0.5;  // a correlation that stands beside the answer

/// "the orientation of wrist0" for the channel wrist0_orientation_rad.
std::string SpokenName(const std::string& channel) {
  const auto first = channel.find('_'), last = channel.rfind('_');
  if (first == std::string::npos || first == last) return channel;
  return fmt::format("the {} of {}", channel.substr(first + 1, last - first - 1),
                     channel.substr(0, first));
}

std::string MemoryWarning(const ResidualMemory& memory) {
  return fmt::format(
      "what is left of {} remembers itself ({:.2f} from sample to sample): slow noise or an error "
      "of the model is in it, and the probability holds among the known causes alone; {}",
      SpokenName(memory.channel), memory.correlation,
      memory.SamplesAsOne() > 1.0
          ? fmt::format("{:.1f} samples count as one", memory.SamplesAsOne())
          : std::string("the noise taken covers the memory"));
}

/// What the stages work on. The layout refers to the samples, the replays to both.
struct Work {
  SampleSet samples;
  ParameterLayout layout;
  Replay base, extended;

  Work(const Recording& recording, const std::string& name, const DiagnoseOptions& options)
      : samples(MakeSampleSet(recording, name)),
        layout(samples, MakeCatalogue(samples, options.without, options.own_effects)),
        base(samples, layout),
        extended(samples, layout) {}
};

/// The base simulation, with the sensors' frames registered as well as the data allow.
void ReplayBase(Work& work, const std::string& name) {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(work.layout.Size());
  if (!work.base.Evaluate(theta)) {
    throw WorkError(fmt::format(
        "{}: the nominal instrument has no equilibrium in {} of {} samples: check length, port and "
        "load",
        name, work.base.FailedSamples(), work.samples.samples.size()));
  }
  const bool uncertain = std::any_of(work.layout.Blocks().begin(), work.layout.Blocks().end(),
                                     [](const auto& block) { return block.nuisance; });
  for (int i = 0; uncertain && i < 3; ++i) {
    theta = BaseParameters(MakeLinearProblem(work.base, {}, 1).total, work.layout);
    work.base.Evaluate(theta);
  }
}

Eigen::VectorXd ReportedValues(const ParameterLayout::Block& block, const Eigen::VectorXd& theta,
                               const Eigen::MatrixXd& covariance) {
  std::vector<double> values;
  for (const auto& p : block.effect->Report(theta, covariance))
    values.insert(values.end(), p.value.begin(), p.value.end());
  return Eigen::Map<Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

/// Of the reported numbers of `blocks`, from that of the fitted ones by differences.
Eigen::MatrixXd ReportedCovariance(const ParameterLayout& layout, const std::vector<int>& blocks,
                                   const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd J(0, theta.size());
  for (const int b : blocks) {
    const auto& block = layout.Blocks()[b];
    const Eigen::VectorXd own = theta.segment(block.first, block.size);
    const Eigen::MatrixXd C = covariance.block(block.first, block.first, block.size, block.size);
    const auto rows = ReportedValues(block, own, C).size();
    J.conservativeResize(J.rows() + rows, Eigen::NoChange);
    J.bottomRows(rows).setZero();
    for (int j = 0; j < block.size; ++j) {
      const Eigen::VectorXd h = 1e-3 * std::sqrt(C(j, j)) * Eigen::VectorXd::Unit(block.size, j);
      J.col(block.first + j).tail(rows) =
          (ReportedValues(block, own + h, C) - ReportedValues(block, own - h, C)) / (2 * h[j]);
    }
  }
  return J * covariance.topLeftCorner(theta.size(), theta.size()) * J.transpose();
}

/// Of the first `effects` that are not `present`, those that act on sensors' readings or places
/// alone.
std::vector<int> SensorBlocks(const Replay& extended, int effects,
                              const std::vector<int>& present) {
  std::set<int> sensors, others;
  for (const ReplayedSample& sample : extended.Samples()) {
    for (const InputChange::Column& column : sample.columns) {
      const bool reading = column.input > sample_input::kTipCompliance &&
                           column.input != sample_input::kEmDelay &&
                           column.input != sample_input::kCameraDelay;
      const bool length = column.input == sample_input::kLength;  // where the sensors stand
      (reading || length ? sensors : others).insert(column.parameter);
    }
  }
  std::vector<int> blocks;
  for (int b = 0; b < effects; ++b) {
    const auto& block = extended.Layout().Blocks()[b];
    bool alone = std::find(present.begin(), present.end(), b) == present.end();
    for (int j = block.first; j < block.first + block.size; ++j)
      alone = alone && sensors.contains(j) && !others.contains(j);
    if (alone) blocks.push_back(b);
  }
  return blocks;
}

/// The catalogue's best answer, whatever the verdict: what the extended model is made of. The first
/// `effects` of the layout are the catalogue's.
void DescribeParameters(const Replay& extended, int effects, const Selection& selection,
                        const WeighedHypothesis& weighed, DiagnosisResult& result) {
  const ParameterLayout& layout = extended.Layout();
  const Evidence evidence(selection.problem.total, layout, selection.generic_sd,
                          {.unknown_sd = {}});
  const Eigen::MatrixXd covariance = evidence.Covariance(weighed);
  Eigen::VectorXd theta = extended.Theta();
  for (int j = 0; j < layout.Size(); ++j)  // within tolerance the fit does not mind the sign
    if (layout.Parameter(j).positive) theta[j] = std::max(0.0, theta[j]);
  std::vector<int> named = weighed.hypothesis.effects;
  std::erase_if(named, [&](int b) { return b >= effects; });
  result.covariance = ReportedCovariance(layout, named, theta, covariance);
  const std::vector<int> sensors = SensorBlocks(extended, effects, named);
  result.sensor_tolerance.covariance = ReportedCovariance(layout, sensors, theta, covariance);
  for (const int b : sensors)
    result.sensor_tolerance.effects.push_back(layout.Blocks()[b].effect->Name());
  for (int b = 0; b < effects; ++b) {
    const auto& block = layout.Blocks()[b];
    EffectFit fit{
        block.effect->Name(),
        block.effect->Report(theta.segment(block.first, block.size),
                             covariance.block(block.first, block.first, block.size, block.size))};
    const bool is_present = std::find(named.begin(), named.end(), b) != named.end();
    (is_present ? result.parameters : result.within_tolerance).push_back(std::move(fit));
  }
}

void DescribeAmbiguity(const Work& work, const Selection& selection,
                       const WeighedHypothesis& weighed, DiagnosisResult& result) {
  const Ambiguity ambiguity = FindAmbiguity(work.extended, work.layout, selection, weighed);
  for (const auto& group : ambiguity.groups) {
    std::vector<std::string> names;
    names.reserve(group.size());
    for (const int b : group) names.push_back(work.layout.Blocks()[b].effect->Name());
    result.indistinguishable.push_back(names);
  }
  result.separating_motion = ambiguity.separating_motion;
  result.separating_motion_score = ambiguity.separating_score;
}

/// Terms without a name explain the recording better than any effect: what the answer keeps of the
/// known causes is what it keeps where none of them is adequate.
void TurnUnknown(DiagnosisResult& result) {
  if (result.verdict == Verdict{"unknown"}) return;
  const double kept = ProbabilityOptions().inadequate_known;
  double known = 0.0;
  for (const auto& h : result.probabilities)
    if (h.verdict != Verdict{"unknown"}) known += h.probability;
  const double factor = known > kept ? kept / known : 1.0;
  for (auto& h : result.probabilities)
    h.probability = h.verdict == Verdict{"unknown"} ? 1.0 - factor * known : factor * h.probability;
  for (auto& [effect, presence] : result.presence) presence *= factor;
  std::stable_sort(result.probabilities.begin(), result.probabilities.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  result.verdict = {"unknown"};
  result.credible_set = {{"unknown"}};
}

void DescribeRecording(const Work& work, const Selection& selection, const Recording& recording,
                       DiagnosisResult& result) {
  result.samples = int(work.samples.samples.size());
  result.failed_samples = work.extended.FailedSamples();
  result.fits = selection.fits;
  result.converged = selection.converged;
  result.has_load = work.samples.has_load;
  result.warnings.insert(result.warnings.begin(), work.samples.warnings.begin(),
                         work.samples.warnings.end());
  result.noise_scale = work.extended.NoiseScales();
  result.centre_m = work.samples.centre;
  result.start_ns = recording.wrist0->samples.front().t_ns;
  for (int b = 0; b < work.layout.EffectCount(); ++b) {
    const auto& block = work.layout.Blocks()[b];
    result.catalogue.push_back(block.effect->Name());
    result.summaries[block.effect->Name()] = block.effect->Summary();
    const Eigen::VectorXd tolerance = work.layout.Tolerances().segment(block.first, block.size);
    result.nominal.push_back(
        {block.effect->Name(), block.effect->Report(Eigen::VectorXd::Zero(block.size),
                                                    tolerance.cwiseAbs2().asDiagonal())});
  }
  const Rows sd = work.extended.RowNoise(work.samples.samples.size() / 2);
  for (int c = 0; c < kChannelCount; ++c)
    result.noise_sd[c] = std::sqrt(
        sd.segment(kChannels[c].first_row, kChannels[c].rows).squaredNorm() / kChannels[c].rows);
}

void RequireKnown(const DiagnoseOptions& options) {
  for (const std::string& effect : options.without) {
    if (MakeEffect(effect, options.own_effects)) continue;
    throw InputError(
        fmt::format("{}, to be left out: no effect of that name is in the catalogue", effect));
  }
}

}  // namespace

std::string Joined(const Verdict& verdict) {
  std::string joined;
  for (const auto& name : verdict) joined += (joined.empty() ? "" : "+") + name;
  return joined;
}

bool NamesEffects(const Verdict& verdict) {
  return verdict != Verdict{"none"} && verdict != Verdict{"unknown"};
}

bool DiagnosisResult::IsAdequate() const {
  if (memory.correlation <= kLongMemory) return true;
  if (verdict == Verdict{"unknown"})
    return true;  // the answer itself says that more is in the data
  // Where nothing is named, a slow rest that is smaller than the noise is no matter.
  return verdict == Verdict{"none"} && memory.SamplesAsOne() <= 1.0;
}

DiagnosisResult Diagnose(const Recording& recording, const std::string& name,
                         const DiagnoseOptions& options) {
  RequireKnown(options);
  DiagnosisResult result;
  Work work(recording, name, options);
  ReplayBase(work, name);
  result.signatures = FindSignatures(work.base);
  const SelectionOptions selection_options;
  const Selection selection = Select(work.extended, work.layout, selection_options);
  if (selection.far_samples > 0) {
    result.warnings.push_back(
        fmt::format("{} of {} samples are far from what any model says: left out",
                    selection.far_samples, work.samples.samples.size()));
  }
  result.memory = selection.memory;
  const Probabilities probabilities = MakeProbabilities(selection, work.layout, selection_options);
  result.probabilities = probabilities.hypotheses;
  result.presence = probabilities.presence;
  result.credible_set = probabilities.credible_set;
  result.verdict = probabilities.hypotheses.front().verdict;
  if (!result.IsAdequate()) result.warnings.push_back(MemoryWarning(selection.memory));
  const WeighedHypothesis& known = selection.BestKnown();
  work.base.TakeSettings(work.extended);
  std::unique_ptr<TermModel> terms;
  if (options.discover) terms = FindTerms(work.base, work.extended, selection, known, options);
  if (terms && !NamesEffects(terms->Named())) TurnUnknown(result);
  const Replay& base = terms ? terms->base : work.base;
  const Replay& extended = terms ? terms->extended : work.extended;
  const Selection& chosen = terms ? terms->selection : selection;
  const WeighedHypothesis& model = terms ? terms->weighed : known;
  if (NamesEffects(result.verdict)) DescribeAmbiguity(work, selection, known, result);
  if (terms) result.discovered = DescribeTerms(*terms, options.measure_gain);
  DescribeParameters(extended, work.layout.EffectCount(), chosen, model, result);
  if (options.measure_gain) {
    const HeldOut heldout = MeasureHeldOut(base, extended, chosen, model);
    result.base = heldout.base;
    result.extended = heldout.extended;
    result.gain = heldout.gain;
  }
  result.residuals = MakeResidualTable(base, extended);
  DescribeRecording(work, selection, recording, result);
  return result;
}

}  // namespace flextip::diagnosis
